/*
 * Two palms squeeze a small wooden box, the pedestal under it is taken away, the box stays; a load pulls
 * at it, the palms carry it up and let it drop. Once with palms that push without lag, once with palms
 * that have a mass.
 *
 * Prints a line for each: kept or dropped, how far the box sank, the force on a hand, how many contacts
 * began, stayed and ended, and the hash of the final state. Exits with 1 and a line that says what went
 * wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

#define CLOSED 60
#define SUPPORT_GONE 120
#define LOAD_FROM 180
#define LOAD_TO 240
#define LIFT_TO 300
#define OPEN 360
#define NUDGED 540
#define FRAMES 560
#define PALMS 2
#define BOX_HALF 0.03f
#define TOP 0.2f
#define MIDDLE (TOP + BOX_HALF + 0.0003f)
#define WIDE 0.12f
#define SQUEEZED 0.023f
#define LIFT 0.1f
#define LOAD_N 2.0f

typedef struct scene {
    palp_world *world;
    palp_body_id pedestal, box, palms[PALMS];
} scene;

typedef struct tally {
    uint32_t begun, stayed, ended;
    float sunk_m, deepest_m, force_n;
} tally;

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

static palp_pose pose_at(float x, float y) {
    palp_pose pose = PALP_POSE_IDENTITY;
    pose.position.x = x;
    pose.position.y = y;
    return pose;
}

static palp_body_id add_box(palp_world *world, const palp_body_def *body, palp_vec3 half,
                            uint32_t material, float radius_m) {
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_body_id id;
    palp_piece_id piece_id;
    piece.shape = PALP_SHAPE_BOX;
    piece.a = half;
    piece.material = material;
    piece.radius_m = radius_m;
    ok(palp_body_add(world, body, &id), "palp_body_add");
    ok(palp_piece_add(world, id, &piece, &piece_id), "palp_piece_add");
    return id;
}

static scene make_scene(palp_world *world, uint32_t push) {
    const palp_vec3 floor_half = {1.0f, 0.05f, 1.0f}, pedestal_half = {0.02f, 0.1f, 0.02f};
    const palp_vec3 box_half = {BOX_HALF, BOX_HALF, BOX_HALF}, palm_half = {0.008f, 0.04f, 0.04f};
    palp_body_def body = PALP_BODY_DEF_INIT;
    scene made;
    int palm;
    made.world = world;
    body.pose = pose_at(0.0f, -0.05f);
    add_box(world, &body, floor_half, PALP_MATERIAL_WOOD, 0.0f);
    body.pose = pose_at(0.0f, TOP - 0.1f);
    made.pedestal = add_box(world, &body, pedestal_half, PALP_MATERIAL_WOOD, 0.0f);
    body.kind = PALP_KIND_DYNAMIC;
    body.pose = pose_at(0.0f, MIDDLE);
    made.box = add_box(world, &body, box_half, PALP_MATERIAL_WOOD, 0.0f);
    body.kind = PALP_KIND_DRIVEN;
    body.coupling.push = push;
    for (palm = 0; palm < PALMS; palm++) {
        body.pose = pose_at(palm == 0 ? -WIDE : WIDE, MIDDLE);
        made.palms[palm] = add_box(world, &body, palm_half, PALP_MATERIAL_HUMAN, 0.005f);
    }
    return made;
}

/* From 0 at one frame to 1 at another. */
static float share_of(int frame, int from, int to) {
    if (frame <= from) {
        return 0.0f;
    }
    return frame >= to ? 1.0f : (float)(frame - from) / (float)(to - from);
}

/* Where the right palm's tracker is; the left one's is opposite. */
static palp_pose right_palm_at(int frame) {
    const float closed = share_of(frame, 0, CLOSED) - share_of(frame, OPEN, OPEN + 30);
    return pose_at(WIDE + (SQUEEZED - WIDE) * closed,
                   MIDDLE + LIFT * share_of(frame, LOAD_TO, LIFT_TO));
}

static void drive(const scene *s, int frame) {
    const palp_vec3 load = {0.0f, -LOAD_N, 0.0f}, none = {0.0f, 0.0f, 0.0f};
    palp_pose seen = right_palm_at(frame);
    ok(palp_body_set_target(s->world, s->palms[1], &seen), "palp_body_set_target");
    seen.position.x = -seen.position.x;
    ok(palp_body_set_target(s->world, s->palms[0], &seen), "palp_body_set_target");
    if (frame == SUPPORT_GONE) {
        ok(palp_body_remove(s->world, s->pedestal), "palp_body_remove");
    }
    if (frame >= LOAD_FROM && frame < LOAD_TO) {
        ok(palp_body_apply_force(s->world, s->box, &load, &none), "palp_body_apply_force");
    }
}

/* Counts what touches, and believes neither the order nor the numbers. */
static void count_events(const scene *s, const palp_frame_report *report, tally *sums, int frame) {
    const palp_contact_event *events;
    uint32_t count, i;
    ok(palp_contact_events(s->world, &events, &count), "palp_contact_events");
    check(count == report->events && report->events_dropped == 0, "events are miscounted", frame);
    for (i = 0; i < count; i++) {
        const palp_contact_event *event = &events[i];
        const palp_vec3 n = event->normal;
        const float length = n.x * n.x + n.y * n.y + n.z * n.z;
        sums->begun += event->kind == PALP_EVENT_BEGIN;
        sums->stayed += event->kind == PALP_EVENT_STAY;
        sums->ended += event->kind == PALP_EVENT_END;
        check(event->kind >= PALP_EVENT_BEGIN && event->kind <= PALP_EVENT_END, "no kind", frame);
        check(event->material_a <= PALP_MATERIAL_HUMAN && event->material_b <= PALP_MATERIAL_HUMAN,
              "a material that is not in the scene", frame);
        check(length > 0.999f && length < 1.001f, "an event without normal", frame);
        check(event->kind != PALP_EVENT_END || event->impulse_n_s == 0.0f, "a late impulse", frame);
        check(event->approach_m_s >= 0.0f && event->slide_m_s >= 0.0f, "a negative speed", frame);
    }
}

/* How deep the box and a palm overlap, judged by their published poses, and how far the box sank. */
static void measure(const scene *s, tally *sums, int frame) {
    palp_pose box;
    int palm;
    ok(palp_body_pose(s->world, s->box, &box), "palp_body_pose");
    if (frame >= SUPPORT_GONE && frame < OPEN) {
        const float sunk = right_palm_at(frame).position.y - box.position.y;
        sums->sunk_m = sunk > sums->sunk_m ? sunk : sums->sunk_m;
    }
    for (palm = 0; palm < PALMS; palm++) {
        palp_penetration_result found = PALP_PENETRATION_RESULT_INIT;
        ok(palp_penetration(s->world, s->box, s->palms[palm], &found), "palp_penetration");
        sums->deepest_m = found.depth_m > sums->deepest_m ? found.depth_m : sums->deepest_m;
    }
}

/* What the haptic device of the right hand is told while the box is held. */
static float force_on_the_hand(const scene *s) {
    palp_driven_state state = PALP_DRIVEN_STATE_INIT;
    ok(palp_driven_report(s->world, s->palms[1], &state), "palp_driven_report");
    return state.force_n.x > state.reaction_n.x ? state.force_n.x : state.reaction_n.x;
}

static uint32_t is_asleep(const scene *s) {
    uint32_t asleep = 9;
    ok(palp_body_is_asleep(s->world, s->box, &asleep), "palp_body_is_asleep");
    return asleep;
}

static void nudge(const scene *s) {
    const palp_vec3 impulse = {0.0f, 0.05f, 0.0f};
    palp_pose box;
    check(is_asleep(s) == 1, "the box does not sleep on the floor", NUDGED);
    ok(palp_body_pose(s->world, s->box, &box), "palp_body_pose");
    ok(palp_body_apply_impulse(s->world, s->box, &impulse, &box.position),
       "palp_body_apply_impulse");
    check(is_asleep(s) == 0, "a nudge does not wake the box", NUDGED);
}

static tally run(const scene *s) {
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    tally sums = {0, 0, 0, 0.0f, 0.0f, 0.0f};
    int frame;
    input.dt_s = 1.0f / 90.0f;
    for (frame = 0; frame < FRAMES; frame++) {
        palp_frame_report report = PALP_FRAME_REPORT_INIT;
        drive(s, frame);
        if (frame == NUDGED) {
            nudge(s);
        }
        ok(palp_frame_step(s->world, &input, &report), "palp_frame_step");
        count_events(s, &report, &sums, frame);
        measure(s, &sums, frame);
        if (frame == LOAD_FROM - 1) {
            sums.force_n = force_on_the_hand(s);
        }
    }
    return sums;
}

/* The next address that a block may start at. */
static void *aligned(void *memory) {
    uintptr_t address = (uintptr_t)memory;
    uintptr_t past = address % PALP_BLOCK_ALIGNMENT;
    return (char *)memory + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

static void hold(const char *name, uint32_t push) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    const size_t bytes = palp_memory_bytes(&room);
    void *memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    palp_world *world;
    uint64_t hash;
    scene made;
    tally sums;
    check(memory != NULL, "no memory", 0);
    ok(palp_world_create(aligned(memory), bytes, &room, &world), "palp_world_create");
    made = make_scene(world, push);
    sums = run(&made);
    ok(palp_state_hash(world, &hash), "palp_state_hash");
    printf("%s: %s, sank %.2f mm, %.1f N, overlap %.3f mm, begun %u stayed %u ended %u, hash %016" PRIx64
           "\n",
           name, sums.sunk_m < 5e-3f ? "kept" : "dropped", (double)(sums.sunk_m * 1000.0f),
           (double)sums.force_n, (double)(sums.deepest_m * 1000.0f), (unsigned)sums.begun,
           (unsigned)sums.stayed, (unsigned)sums.ended, hash);
    check(sums.deepest_m < 1e-3f, "a palm is in the box", FRAMES);
    check(sums.force_n > 1.0f, "the hand feels nothing", FRAMES);
    check(sums.begun >= sums.ended && sums.ended >= 3, "contacts begin or end unseen", FRAMES);
    free(memory);
}

int main(void) {
    hold("without lag", PALP_PUSH_WITHOUT_LAG);
    hold("with mass", PALP_PUSH_WITH_MASS);
    return 0;
}
