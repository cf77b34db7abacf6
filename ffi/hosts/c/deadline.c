/*
 * Two hands press on a table beside a ball that rolls, in frames that are given too little time: by prices,
 * by a clock, and below the floor. A second world is stepped with the units that the first one reports and
 * comes to the same state.
 *
 * Prints how many frames were cut by prices, by the clock and below the floor, and the hash of the final
 * state. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

#define FRAMES 180
#define HANDS 2

typedef struct scene {
    void *memory;
    palp_world *world;
    palp_body_id hands[HANDS];
} scene;

static void check(int good, const char *what, int frame) {
    if (!good) {
        printf("frame %d: %s\n", frame, what);
        exit(1);
    }
}

static void ok(palp_status status, const char *what) {
    if (status < 0) {
        printf("%s: %s\n", what, palp_status_text(status));
        exit(1);
    }
}

static palp_body_id add(palp_world *world, uint32_t kind, float x, float y, float half, float radius_m) {
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_body_id id;
    palp_piece_id piece_id;
    body.kind = kind;
    body.pose.position.x = x;
    body.pose.position.y = y;
    piece.shape = half > 0.0f ? PALP_SHAPE_BOX : PALP_SHAPE_POINT;
    piece.a.x = piece.a.y = piece.a.z = half;
    piece.radius_m = radius_m;
    ok(palp_body_add(world, &body, &id), "palp_body_add");
    ok(palp_piece_add(world, id, &piece, &piece_id), "palp_piece_add");
    return id;
}

static scene make_scene(void) {
    const palp_capacities capacities = PALP_CAPACITIES_ROOM;
    const palp_vec3 linear = {1.0f, 0.0f, 0.0f}, angular = {0.0f, 0.0f, -20.0f};
    scene made;
    const size_t bytes = palp_memory_bytes(&capacities);
    palp_body_id ball;
    made.memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    if (made.memory == NULL) {
        printf("no memory\n");
        exit(1);
    }
    ok(palp_world_create((char *)made.memory + PALP_BLOCK_ALIGNMENT -
                             (uintptr_t)made.memory % PALP_BLOCK_ALIGNMENT,
                         bytes, &capacities, &made.world),
       "palp_world_create");
    add(made.world, PALP_KIND_FIXED, 0.0f, -2.0f, 2.0f, 0.0f);
    made.hands[0] = add(made.world, PALP_KIND_DRIVEN, -1.0f, 0.3f, 0.04f, 0.01f);
    made.hands[1] = add(made.world, PALP_KIND_DRIVEN, -0.5f, 0.3f, 0.04f, 0.01f);
    ball = add(made.world, PALP_KIND_DYNAMIC, 0.0f, 0.0501f, 0.0f, 0.05f);
    ok(palp_body_set_velocity(made.world, ball, &linear, &angular), "palp_body_set_velocity");
    return made;
}

static void track(const scene *s, int frame) {
    int hand;
    for (hand = 0; hand < HANDS; hand++) {
        palp_pose seen = PALP_POSE_IDENTITY;
        seen.position.x = -1.0f + 0.5f * (float)hand;
        seen.position.y = frame < 10 ? 0.3f : -0.1f;
        seen.position.z = 0.0078125f * (float)frame;
        ok(palp_body_set_target(s->world, s->hands[hand], &seen), "palp_body_set_target");
    }
}

static uint64_t hash(const palp_world *world) {
    uint64_t value;
    ok(palp_state_hash(world, &value), "palp_state_hash");
    return value;
}

/* Counts how often it was asked. */
static uint64_t tick(void *user) {
    uint64_t *ticks = (uint64_t *)user;
    *ticks += 1;
    return *ticks;
}

int main(void) {
    const palp_costs costs = {900, 50, 20, 100, 300, 2000, 3000, 5000};
    scene first = make_scene(), twin = make_scene();
    unsigned short_frames = 0, late = 0, below = 0;
    int frame;
    for (frame = 0; frame < FRAMES; frame++) {
        palp_frame_input input = PALP_FRAME_INPUT_INIT;
        palp_frame_report report = PALP_FRAME_REPORT_INIT, again = PALP_FRAME_REPORT_INIT;
        uint64_t floor_ns, ticks = 0;
        palp_status status;
        track(&first, frame);
        track(&twin, frame);
        ok(palp_frame_floor(first.world, &costs, &floor_ns), "palp_frame_floor");
        if (frame % 3 == 2) {
            status = palp_frame_step_by_clock(first.world, &input, &report, tick, &ticks, 1 + frame % 7);
            late += status == PALP_LATE || (report.flags & PALP_FRAME_LATE) != 0;
        } else {
            input.costs = costs;
            input.deadline_ns = (uint32_t)floor_ns + (frame % 3 == 0 ? 9000u : 0u) - (frame % 15 == 1);
            input.has_focus = 1;
            input.focus.x = frame % 2 == 0 ? -1.0f : -0.5f;
            status = palp_frame_step(first.world, &input, &report);
            check(report.floor_ns == floor_ns, "the floor is not the one foretold", frame);
            check(report.priced_ns <= input.deadline_ns || report.priced_ns == floor_ns,
                  "the frame cost more than its deadline", frame);
            short_frames += (report.flags & PALP_FRAME_OUT_OF_TIME) != 0;
            below += (report.flags & PALP_FRAME_BELOW_FLOOR) != 0;
        }
        ok(status, "a step");
        input.deadline_ns = 0;
        input.advance_units = report.advance_units;
        input.impulse_units = report.impulse_units;
        input.reach_steps = report.reach_steps;
        ok(palp_frame_step(twin.world, &input, &again), "palp_frame_step");
        check(hash(first.world) == hash(twin.world), "the twin came to another state", frame);
    }
    check(palp_frame_step_by_clock(first.world, NULL, NULL, NULL, NULL, 0) == PALP_NULL,
          "no clock was taken for one", frame);
    printf("short %u, late %u, below the floor %u\n", short_frames, late, below);
    check(short_frames > 20 && late > 20 && below > 5, "too few frames were cut", frame);
    printf("hash %016" PRIx64 "\n", hash(first.world));
    free(first.memory);
    free(twin.memory);
    return 0;
}
