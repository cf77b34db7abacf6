/*
 * A hand that a plate keeps from its tracker, once for each thing that its coupling may have it do then. The
 * tracker is in a second plate behind the first one: nothing is free there, but a little before it.
 *
 * Prints a line for each: whether the hand was held or snapped, how far it is from its tracker, and the hash of the
 * final state. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

#define FRAMES 60
#define RADIUS 0.05f
#define HALF_THICK 0.01f
#define FIRST 0.2f
#define SECOND 1.2f
#define TRACKER 1.17f
#define SLOP 1e-4f

static void check(int good, const char *what) {
    if (!good) {
        printf("%s\n", what);
        exit(1);
    }
}

static void ok(palp_status status, const char *what) {
    if (status < 0) {
        printf("%s: %s\n", what, palp_status_text(status));
        exit(1);
    }
}

/* The next address that a block may start at. */
static void *aligned(void *memory) {
    uintptr_t address = (uintptr_t)memory;
    uintptr_t past = address % PALP_BLOCK_ALIGNMENT;
    return (char *)memory + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

static palp_body_id add(palp_world *world, const palp_body_def *body, const palp_piece_def *piece) {
    palp_body_id id;
    palp_piece_id piece_id;
    ok(palp_body_add(world, body, &id), "palp_body_add");
    ok(palp_piece_add(world, id, piece, &piece_id), "palp_piece_add");
    return id;
}

static palp_body_id make_scene(palp_world *world, uint32_t snap) {
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT, ball = PALP_PIECE_DEF_INIT;
    piece.shape = PALP_SHAPE_BOX;
    piece.a.x = HALF_THICK;
    piece.a.y = 2.0f;
    piece.a.z = 2.0f;
    body.pose.position.x = FIRST;
    add(world, &body, &piece);
    body.pose.position.x = SECOND;
    add(world, &body, &piece);
    body.kind = PALP_KIND_DRIVEN;
    body.pose.position.x = 0.0f;
    body.coupling.snap = snap;
    ball.shape = PALP_SHAPE_POINT;
    ball.radius_m = RADIUS;
    return add(world, &body, &ball);
}

static void play(const char *name, uint32_t snap, int snaps) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    const size_t bytes = palp_memory_bytes(&room);
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_driven_state state = PALP_DRIVEN_STATE_INIT;
    palp_pose seen = PALP_POSE_IDENTITY, pose;
    void *memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    palp_world *world;
    palp_body_id hand;
    uint64_t hash;
    float wall;
    int frame;
    check(memory != NULL, "no memory");
    ok(palp_world_create(aligned(memory), bytes, &room, &world), "palp_world_create");
    hand = make_scene(world, snap);
    seen.position.x = TRACKER;
    input.dt_s = 1.0f / 90.0f;
    for (frame = 0; frame < FRAMES; frame++) {
        ok(palp_body_set_target(world, hand, &seen), "palp_body_set_target");
        ok(palp_frame_step(world, &input, NULL), "palp_frame_step");
    }
    ok(palp_body_pose(world, hand, &pose), "palp_body_pose");
    ok(palp_driven_report(world, hand, &state), "palp_driven_report");
    ok(palp_state_hash(world, &hash), "palp_state_hash");
    printf("%s: %s, %.1f mm from its tracker, hash %016" PRIx64 "\n", name,
           state.flags & PALP_DRIVEN_DETACHED ? "held" : "snapped",
           (double)(1000.0f * state.displacement_m), hash);
    wall = (snaps ? SECOND : FIRST) - HALF_THICK;
    check(pose.position.x + RADIUS <= wall, "the hand is in a plate");
    check(pose.position.x + RADIUS >= wall - SLOP, "the hand does not touch the plate");
    check(((state.flags & PALP_DRIVEN_DETACHED) == 0) == snaps, "the hand is not where it says");
    free(memory);
}

int main(void) {
    play("never", PALP_SNAP_NEVER, 0);
    play("when free", PALP_SNAP_WHEN_FREE, 0);
    play("near", PALP_SNAP_NEAR, 1);
    return 0;
}
