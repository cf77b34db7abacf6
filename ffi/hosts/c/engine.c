/*
 * A physics engine of the host's own, as small as can be: one ball, gravity, a table that ends and the
 * ground below. One hand pushes the ball along the table and over its edge, another one catches it in its
 * hollow palm and lifts it. The library knows of the ball as a hosted body, and of nothing else.
 *
 * Prints what came of it and the hash of the final state. Inputs use float + - * / alone, so that any
 * language can make the same ones. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

#define FRAMES 540
#define STEP_S (1.0f / 90.0f)
#define PUSH_FROM 60
#define PUSH_TO 210
#define LIFT_FROM 300
#define LIFT_TO 420
#define CARRIED 480
#define GRAVITY 9.81f
#define BALL_RADIUS 0.05f
#define BALL_MASS 0.4f
#define BALL_MOMENT (0.4f * BALL_MASS * BALL_RADIUS * BALL_RADIUS)
#define TABLE_TOP 0.8f
#define TABLE_END 0.1f
#define BOUNCE 0.3f
#define FRICTION 0.3f
#define HOLLOW_X 0.2f
#define HOLLOW_Y 0.6f
#define RIM 5
#define LIFT 0.3f
#define CARRY 0.15f

/* ---- The host's engine. It knows nothing of the library but where to keep what the library asks. ---- */

typedef struct thing {
    palp_vec3 at, velocity, spin;
    palp_hosted_input told;
    palp_hosted_state felt;
} thing;

static float at_most(float x, float most) {
    return x > most ? most : (x < -most ? -most : x);
}

/* A bounce, and friction that makes the ball roll, at the lowest point. */
static void touch_ground(thing *b, float ground) {
    float push, slip_x, slip_z, along_x, along_z;
    if (b->at.y - BALL_RADIUS > ground || b->velocity.y > 0.0f) {
        return;
    }
    push = BALL_MASS * (0.0f - b->velocity.y);
    if (b->velocity.y < -0.2f) {
        push = push + push * BOUNCE;
    }
    slip_x = b->velocity.x + b->spin.z * BALL_RADIUS;
    slip_z = b->velocity.z - b->spin.x * BALL_RADIUS;
    /* Two sevenths of the mass answer at the lowest point of a ball that may turn. */
    along_x = at_most(slip_x * (BALL_MASS * 2.0f / 7.0f), FRICTION * push);
    along_z = at_most(slip_z * (BALL_MASS * 2.0f / 7.0f), FRICTION * push);
    b->velocity.x = b->velocity.x - along_x / BALL_MASS;
    b->velocity.y = b->velocity.y + push / BALL_MASS;
    b->velocity.z = b->velocity.z - along_z / BALL_MASS;
    b->spin.z = b->spin.z - along_x * BALL_RADIUS / BALL_MOMENT;
    b->spin.x = b->spin.x + along_z * BALL_RADIUS / BALL_MOMENT;
}

/* One step of semi-implicit Euler, after the impulses of hands. */
static void step_engine(thing *b) {
    const palp_vec3 push = b->felt.impulse_n_s, turn = b->felt.angular_n_m_s;
    const float ground = b->at.x < TABLE_END ? TABLE_TOP : 0.0f;
    b->velocity.x = b->velocity.x + push.x / BALL_MASS;
    b->velocity.y = b->velocity.y + push.y / BALL_MASS;
    b->velocity.z = b->velocity.z + push.z / BALL_MASS;
    b->spin.x = b->spin.x + turn.x / BALL_MOMENT;
    b->spin.y = b->spin.y + turn.y / BALL_MOMENT;
    b->spin.z = b->spin.z + turn.z / BALL_MOMENT;
    b->velocity.y = b->velocity.y - GRAVITY * STEP_S;
    touch_ground(b, ground);
    b->at.x = b->at.x + b->velocity.x * STEP_S;
    b->at.y = b->at.y + b->velocity.y * STEP_S;
    b->at.z = b->at.z + b->velocity.z * STEP_S;
}

/* ---- What connects it to the library. ---- */

typedef struct scene {
    palp_world *world;
    palp_body_id pusher, hollow;
    thing ball;
} scene;

typedef struct tally {
    int pushed, carried;
    float deepest_m, gap_m, lifted_m;
} tally;

static void check(int good, const char *what, int frame) {
    if (!good) {
        printf("frame %d: %s\n", frame, what);
        exit(1);
    }
}

static void ok(palp_status status, const char *what) {
    if (status != PALP_OK) {
        printf("%s: %s\n", what, palp_status_text(status));
        exit(1);
    }
}

static palp_pose pose_at(float x, float y, float z) {
    palp_pose pose = PALP_POSE_IDENTITY;
    pose.position.x = x;
    pose.position.y = y;
    pose.position.z = z;
    return pose;
}

/* Before the library's frame. A ball looks the same from every side: it is told of without orientation. */
static void tell(scene *s) {
    thing *b = &s->ball;
    palp_refusal refusal;
    b->told.pose.position = b->at;
    b->told.velocity_m_s = b->velocity;
    b->told.spin_rad_s = b->spin;
    ok(palp_hosted_set(s->world, &b->told, 1, sizeof *b, &refusal), "palp_hosted_set");
    check(refusal.index == 1 && refusal.status == PALP_OK, "a good entry is refused", 0);
}

/* After the library's frame. */
static void ask(scene *s) {
    ok(palp_hosted_impulse(s->world, s->ball.told.body, &s->ball.felt), "palp_hosted_impulse");
}

static palp_body_id add_body(palp_world *world, uint32_t kind, palp_pose pose) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_body_id body;
    def.kind = kind;
    def.pose = pose;
    ok(palp_body_add(world, &def, &body), "palp_body_add");
    return body;
}

static void add_box(palp_world *world, palp_body_id body, palp_pose local, palp_vec3 half) {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_id piece;
    def.shape = PALP_SHAPE_BOX;
    def.material = PALP_MATERIAL_HUMAN;
    def.local_pose = local;
    def.a = half;
    def.radius_m = 0.004f;
    ok(palp_piece_add(world, body, &def, &piece), "palp_piece_add");
}

/* A palm with a rim, so that a ball stays in it. */
static void add_hollow(palp_world *world, palp_body_id body) {
    const palp_vec3 half[RIM] = {{0.08f, 0.006f, 0.08f},
                                 {0.006f, 0.03f, 0.08f},
                                 {0.006f, 0.03f, 0.08f},
                                 {0.08f, 0.03f, 0.006f},
                                 {0.08f, 0.03f, 0.006f}};
    const palp_vec3 at[RIM] = {{0.0f, -0.01f, 0.0f},
                               {-0.08f, 0.03f, 0.0f},
                               {0.08f, 0.03f, 0.0f},
                               {0.0f, 0.03f, -0.08f},
                               {0.0f, 0.03f, 0.08f}};
    int i;
    for (i = 0; i < RIM; i++) {
        add_box(world, body, pose_at(at[i].x, at[i].y, at[i].z), half[i]);
    }
}

static void add_ball(scene *s) {
    const palp_hosted_input told = PALP_HOSTED_INPUT_INIT;
    const palp_hosted_state felt = PALP_HOSTED_STATE_INIT;
    const palp_vec3 none = {0.0f, 0.0f, 0.0f}, start = {-0.1f, TABLE_TOP + BALL_RADIUS, 0.0f};
    const palp_vec3 moments = {BALL_MOMENT, BALL_MOMENT, BALL_MOMENT};
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_id piece;
    s->ball.at = start;
    s->ball.velocity = s->ball.spin = none;
    s->ball.felt = felt;
    s->ball.told = told;
    s->ball.told.mass_kg = BALL_MASS;
    s->ball.told.moments_kg_m2 = moments;
    s->ball.told.body = add_body(s->world, PALP_KIND_HOSTED, pose_at(start.x, start.y, start.z));
    def.shape = PALP_SHAPE_POINT;
    def.radius_m = BALL_RADIUS;
    ok(palp_piece_add(s->world, s->ball.told.body, &def, &piece), "palp_piece_add");
}

/* From 0 at one frame to 1 at another. */
static float share_of(int frame, int from, int to) {
    if (frame <= from) {
        return 0.0f;
    }
    return frame >= to ? 1.0f : (float)(frame - from) / (float)(to - from);
}

static palp_pose pusher_at(int frame) {
    const float gone = share_of(frame, PUSH_FROM, PUSH_TO) - share_of(frame, PUSH_TO, LIFT_FROM);
    return pose_at(-0.25f + 0.4f * gone, TABLE_TOP + BALL_RADIUS, 0.0f);
}

static palp_pose hollow_at(int frame) {
    return pose_at(HOLLOW_X + CARRY * share_of(frame, LIFT_TO, CARRIED),
                   HOLLOW_Y + LIFT * share_of(frame, LIFT_FROM, LIFT_TO), 0.0f);
}

static void make_scene(scene *s) {
    const palp_vec3 palm = {0.008f, 0.04f, 0.04f};
    add_ball(s);
    s->pusher = add_body(s->world, PALP_KIND_DRIVEN, pusher_at(0));
    add_box(s->world, s->pusher, pose_at(0.0f, 0.0f, 0.0f), palm);
    s->hollow = add_body(s->world, PALP_KIND_DRIVEN, hollow_at(0));
    add_hollow(s->world, s->hollow);
}

/* The drawn hand and the ball where the host's engine has it, at the end of the same frame. */
static float gap_between(const scene *s, palp_body_id hand) {
    const palp_pose ball_at = pose_at(s->ball.at.x, s->ball.at.y, s->ball.at.z);
    palp_penetration_result found = PALP_PENETRATION_RESULT_INIT;
    palp_pose drawn;
    ok(palp_body_pose(s->world, hand, &drawn), "palp_body_pose");
    ok(palp_penetration_at(s->world, hand, &drawn, s->ball.told.body, &ball_at, &found),
       "palp_penetration_at");
    return found.distance_m - found.depth_m;
}

static void step_frame(scene *s, int frame) {
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    const palp_pose pusher = pusher_at(frame), hollow = hollow_at(frame);
    input.dt_s = STEP_S;
    tell(s);
    ok(palp_body_set_target(s->world, s->pusher, &pusher), "palp_body_set_target");
    ok(palp_body_set_target(s->world, s->hollow, &hollow), "palp_body_set_target");
    ok(palp_frame_step(s->world, &input, NULL), "palp_frame_step");
    ask(s);
    step_engine(&s->ball);
}

static tally run(scene *s) {
    tally sums = {0, 0, 0.0f, 0.0f, 0.0f};
    float begun_at = 0.0f;
    int frame;
    for (frame = 0; frame < FRAMES; frame++) {
        float pusher, hollow;
        step_frame(s, frame);
        pusher = gap_between(s, s->pusher);
        hollow = gap_between(s, s->hollow);
        sums.pushed += frame < PUSH_TO && s->ball.felt.impulse_n_s.x > 0.0f;
        sums.carried += frame >= LIFT_FROM && s->ball.felt.impulse_n_s.y > 0.0f;
        sums.deepest_m = pusher < -sums.deepest_m ? -pusher : sums.deepest_m;
        sums.deepest_m = hollow < -sums.deepest_m ? -hollow : sums.deepest_m;
        sums.gap_m = hollow;
        if (frame == LIFT_FROM) {
            begun_at = s->ball.at.y;
        }
    }
    sums.lifted_m = s->ball.at.y - begun_at;
    return sums;
}

/* The next address that a block may start at. */
static void *aligned(void *memory) {
    uintptr_t address = (uintptr_t)memory;
    uintptr_t past = address % PALP_BLOCK_ALIGNMENT;
    return (char *)memory + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

int main(void) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    const size_t bytes = palp_memory_bytes(&room);
    void *memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    uint64_t hash;
    scene made;
    tally sums;
    check(memory != NULL, "no memory", 0);
    ok(palp_world_create(aligned(memory), bytes, &room, &made.world), "palp_world_create");
    make_scene(&made);
    sums = run(&made);
    ok(palp_state_hash(made.world, &hash), "palp_state_hash");
    printf("pushed for %d frames, carried for %d, lifted %.1f mm, overlap %.3f mm, gap at rest %.3f mm\n",
           sums.pushed, sums.carried, (double)(sums.lifted_m * 1000.0f),
           (double)(sums.deepest_m * 1000.0f), (double)(sums.gap_m * 1000.0f));
    printf("hash %016" PRIx64 "\n", hash);
    check(sums.deepest_m < 1e-3f, "a hand and the ball overlap", FRAMES);
    check(sums.lifted_m > 0.29f && sums.lifted_m < 0.31f, "the ball was not lifted", FRAMES);
    check(sums.gap_m < 1e-3f, "the ball floats over the palm", FRAMES);
    free(memory);
    return 0;
}
