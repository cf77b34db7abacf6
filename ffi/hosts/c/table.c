/*
 * A hand over a table: idle in the air, pressing down and sliding, pushing a ball.
 *
 * Prints the hash of the final state. Inputs use float + - * / alone, so that any language can make the
 * same ones. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 600
#define IDLE_END 120
#define TABLE_TOP 0.72f
#define FINGERS 5
#define PIECES (1 + 2 * FINGERS)
#define FINGER_RADIUS 0.008f
#define FINGER_LENGTH 0.035f
#define PALM_X 0.04f
#define PALM_Y 0.008f
#define PALM_Z 0.045f
#define PALM_RADIUS 0.005f
#define BALL_RADIUS 0.04f

/* XrHandJointLocationEXT. */
typedef struct joint_location {
    uint64_t flags;
    palp_pose pose;
    float radius;
} joint_location;

#define JOINT_VALID 3u
#define WRIST 1u

/* Joints of XrHandJointEXT that carry the palm and both pieces of each finger. */
static const uint32_t piece_joints[PIECES] = {0, 3, 4, 7, 9, 12, 14, 17, 19, 22, 24};

/* Frame, then the wrist's position. */
typedef struct key {
    int frame;
    palp_vec3 at;
} key;

static const key keys[] = {
    {0, {-0.25f, 0.85f, 0.05f}},   {60, {-0.20f, 0.87f, 0.0f}},  {120, {-0.25f, 0.85f, 0.05f}},
    {180, {-0.25f, 0.70f, 0.05f}}, {300, {-0.05f, 0.70f, 0.05f}}, {360, {-0.05f, 0.79f, 0.05f}},
    {420, {-0.05f, 0.77f, 0.0f}},  {600, {0.30f, 0.77f, 0.0f}},
};

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

static float between(float from, float to, float share) {
    return from + (to - from) * share;
}

static palp_vec3 wrist_at(int frame) {
    int k = 0;
    float share;
    palp_vec3 at;
    while (frame > keys[k + 1].frame) {
        k++;
    }
    share = (float)(frame - keys[k].frame) / (float)(keys[k + 1].frame - keys[k].frame);
    at.x = between(keys[k].at.x, keys[k + 1].at.x, share);
    at.y = between(keys[k].at.y, keys[k + 1].at.y, share);
    at.z = between(keys[k].at.z, keys[k + 1].at.z, share);
    return at;
}

/* From 0 to 0.3 and back within 60 frames: the tangent of half the angle of a bent finger. */
static float bend_at(int frame) {
    int step = frame % 60;
    return 0.3f * ((float)(step < 30 ? step : 60 - step) / 30.0f);
}

static palp_pose pose_at(float x, float y, float z, float half_tangent) {
    palp_pose pose = PALP_POSE_IDENTITY;
    pose.orientation.x = 0.0f - half_tangent;
    pose.position.x = x;
    pose.position.y = y;
    pose.position.z = z;
    return pose;
}

static void see_hand(int frame, joint_location joints[PALP_HAND_JOINTS]) {
    palp_vec3 w = wrist_at(frame);
    float bend = bend_at(frame);
    uint32_t j;
    int f;
    for (j = 0; j < PALP_HAND_JOINTS; j++) {
        joints[j].flags = JOINT_VALID;
        joints[j].pose = pose_at(w.x, w.y, w.z, 0.0f);
        joints[j].radius = FINGER_RADIUS;
    }
    joints[0].pose = pose_at(w.x, w.y, w.z - 0.05f, 0.0f);
    for (f = 0; f < FINGERS; f++) {
        float x = w.x + (0.02f * (float)f - 0.04f);
        joints[piece_joints[1 + 2 * f]].pose = pose_at(x, w.y, w.z - 0.1f, 0.0f);
        joints[piece_joints[2 + 2 * f]].pose =
            pose_at(x, w.y - 0.02f * bend, w.z - 0.138f, bend);
    }
    /* For a while the tracker does not see one fingertip and takes nonsense for another. */
    if (frame >= 200 && frame < 210) {
        joints[9].flags = 0;
        joints[14].pose.orientation.x = 0.0f;
        joints[14].pose.orientation.w = 0.0f;
    }
}

static palp_body_id add_body(palp_world *world, uint32_t kind, float x, float y, float z) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_body_id body;
    def.kind = kind;
    def.pose = pose_at(x, y, z, 0.0f);
    ok(palp_body_add(world, &def, &body), "palp_body_add");
    return body;
}

static palp_piece_id add_piece(palp_world *world, palp_body_id body, const palp_piece_def *def) {
    palp_piece_id piece;
    ok(palp_piece_add(world, body, def, &piece), "palp_piece_add");
    return piece;
}

static palp_body_id add_fixed_box(palp_world *world, float x, float y, float z, palp_vec3 half) {
    const palp_body_id body = add_body(world, PALP_KIND_FIXED, x, y, z);
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    def.shape = PALP_SHAPE_BOX;
    def.a = half;
    add_piece(world, body, &def);
    return body;
}

static palp_body_id add_table(palp_world *world) {
    const palp_vec3 top = {0.6f, 0.02f, 0.4f};
    const palp_vec3 post = {0.02f, 0.03f, 0.02f};
    const palp_body_id table = add_fixed_box(world, 0.0f, 0.70f, 0.0f, top);
    add_fixed_box(world, 0.0f, 0.75f, 0.04f, post);
    return table;
}

static palp_body_id add_ball(palp_world *world) {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_body_id ball = add_body(world, PALP_KIND_DYNAMIC, 0.15f, 0.761f, -0.08f);
    def.shape = PALP_SHAPE_POINT;
    def.radius_m = BALL_RADIUS;
    add_piece(world, ball, &def);
    return ball;
}

static palp_body_id add_hand(palp_world *world, palp_piece_id pieces[PIECES]) {
    palp_piece_def palm = PALP_PIECE_DEF_INIT;
    palp_piece_def finger = PALP_PIECE_DEF_INIT;
    palp_body_id hand =
        add_body(world, PALP_KIND_DRIVEN, keys[0].at.x, keys[0].at.y, keys[0].at.z);
    int p;
    palm.shape = PALP_SHAPE_BOX;
    palm.material = PALP_MATERIAL_HUMAN;
    palm.a.x = PALM_X;
    palm.a.y = PALM_Y;
    palm.a.z = PALM_Z;
    palm.radius_m = PALM_RADIUS;
    palm.local_pose.position.z = -0.05f;
    pieces[0] = add_piece(world, hand, &palm);
    finger.shape = PALP_SHAPE_SEGMENT;
    finger.material = PALP_MATERIAL_HUMAN;
    finger.b.z = -FINGER_LENGTH;
    finger.radius_m = FINGER_RADIUS;
    for (p = 1; p < PIECES; p++) {
        finger.local_pose = pose_at(0.02f * (float)((p - 1) / 2) - 0.04f, 0.0f,
                               p % 2 == 1 ? -0.1f : -0.138f, 0.0f);
        pieces[p] = add_piece(world, hand, &finger);
    }
    return hand;
}

/* The lowest point of a capsule along -Z of its pose. */
static float lowest_of_finger(const palp_pose *pose) {
    const palp_quat q = pose->orientation;
    float tip = pose->position.y - FINGER_LENGTH * 2.0f * (q.y * q.z - q.w * q.x);
    return (tip < pose->position.y ? tip : pose->position.y) - FINGER_RADIUS;
}

static float size_of(float x) {
    return x < 0.0f ? -x : x;
}

/* The lowest point of the rounded palm. */
static float lowest_of_palm(const palp_pose *pose) {
    const palp_quat q = pose->orientation;
    const float down_x = size_of(2.0f * (q.x * q.y + q.w * q.z)) * PALM_X;
    const float down_y = size_of(1.0f - 2.0f * (q.x * q.x + q.z * q.z)) * PALM_Y;
    const float down_z = size_of(2.0f * (q.y * q.z - q.w * q.x)) * PALM_Z;
    return pose->position.y - down_x - down_y - down_z - PALM_RADIUS;
}

/* Judged by the published poses alone. */
static void check_no_overlap(const palp_world *world, const palp_piece_id pieces[PIECES],
                             palp_body_id ball, int frame) {
    const palp_pose *poses;
    palp_pose ball_pose;
    uint32_t count;
    int p;
    ok(palp_piece_poses(world, &poses, &count), "palp_piece_poses");
    check(lowest_of_palm(&poses[pieces[0].index1 - 1]) > TABLE_TOP - 1e-4f,
          "the palm is in the table", frame);
    for (p = 1; p < PIECES; p++) {
        check(pieces[p].index1 <= count, "a piece without a pose", frame);
        check(lowest_of_finger(&poses[pieces[p].index1 - 1]) > TABLE_TOP - 1e-4f,
              "a finger is in the table", frame);
    }
    ok(palp_body_pose(world, ball, &ball_pose), "palp_body_pose");
    check(ball_pose.position.y - BALL_RADIUS > TABLE_TOP - 1e-3f, "the ball is in the table", frame);
}

/* How many contacts the last frame had, each between two pieces and with a normal. */
static uint32_t count_contacts(const palp_world *world, int frame) {
    const palp_contact *contacts;
    uint32_t count, i;
    ok(palp_contacts(world, &contacts, &count), "palp_contacts");
    for (i = 0; i < count; i++) {
        const palp_vec3 n = contacts[i].normal;
        const float length = n.x * n.x + n.y * n.y + n.z * n.z;
        check(contacts[i].piece_a.index1 != 0 && contacts[i].piece_b.index1 != 0,
              "a contact without pieces", frame);
        check(length > 0.999f && length < 1.001f, "a contact without normal", frame);
        check(contacts[i].gap_m > -1e-3f, "a contact that is too deep", frame);
    }
    return count;
}

static void check_no_lag(const palp_world *world, palp_body_id hand, const palp_pose *target,
                         int frame) {
    palp_pose pose;
    ok(palp_body_pose(world, hand, &pose), "palp_body_pose");
    check(memcmp(&pose, target, sizeof pose) == 0, "the hand lags in free air", frame);
}

static palp_status step_frame(palp_world *world, palp_body_id hand, int frame,
                              joint_location joints[PALP_HAND_JOINTS]) {
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_frame_report report = PALP_FRAME_REPORT_INIT;
    palp_status seen;
    see_hand(frame, joints);
    seen = palp_hand_set_joints(world, hand, joints, sizeof joints[0], NULL, piece_joints, PIECES,
                                0.5f, NULL);
    ok(seen, "palp_hand_set_joints");
    ok(palp_frame_step(world, &input, &report), "palp_frame_step");
    check(report.frame == (uint64_t)frame + 1, "frames are miscounted", frame);
    return seen;
}

static int is_near(float found, float expected) {
    return size_of(found - expected) < 1e-6f;
}

/* The ball over the table, and sunk in it: a known distance and a known depth. */
static void ask(const palp_world *world, palp_body_id ball, palp_body_id table) {
    const palp_pose over = pose_at(0.15f, TABLE_TOP + 0.14f, -0.08f, 0.0f);
    const palp_pose sunk = pose_at(0.15f, TABLE_TOP + 0.03f, -0.08f, 0.0f);
    const palp_pose table_at = pose_at(0.0f, 0.70f, 0.0f, 0.0f);
    palp_penetration_result found = PALP_PENETRATION_RESULT_INIT;
    ok(palp_penetration(world, ball, table, &found), "palp_penetration");
    check(is_near(found.distance_m, 0.001f), "a wrong distance", 0);
    ok(palp_penetration_at(world, ball, &over, table, &table_at, &found), "palp_penetration_at");
    check(is_near(found.distance_m, 0.1f) && found.depth_m == 0.0f, "a wrong distance", 0);
    check(is_near(found.point_b.y, TABLE_TOP) && found.contact_count == 0, "a wrong point", 0);
    ok(palp_penetration_at(world, ball, &sunk, table, &table_at, &found), "palp_penetration_at");
    check(is_near(found.depth_m, 0.01f) && found.distance_m == 0.0f, "a wrong depth", 0);
    check(is_near(found.normal.y, 1.0f) && found.contact_count == 1, "a wrong way out", 0);
    check(is_near(found.contacts[0].gap_m, -0.01f), "a wrong contact", 0);
}

static void run(palp_world *world) {
    joint_location joints[PALP_HAND_JOINTS];
    palp_piece_id pieces[PIECES];
    palp_body_id ball, hand, table;
    palp_pose before, after;
    uint32_t contacts = 0;
    int frame, touching = 0, ignored = 0;
    table = add_table(world);
    ball = add_ball(world);
    ask(world, ball, table);
    hand = add_hand(world, pieces);
    ok(palp_body_pose(world, ball, &before), "palp_body_pose");
    for (frame = 0; frame < FRAMES; frame++) {
        palp_driven_state state = PALP_DRIVEN_STATE_INIT;
        ignored += step_frame(world, hand, frame, joints) == PALP_JOINTS_IGNORED;
        check_no_overlap(world, pieces, ball, frame);
        contacts += count_contacts(world, frame);
        if (frame < IDLE_END) {
            check_no_lag(world, hand, &joints[WRIST].pose, frame);
        }
        ok(palp_driven_report(world, hand, &state), "palp_driven_report");
        touching += (state.flags & PALP_DRIVEN_TOUCHING) != 0;
    }
    ok(palp_body_pose(world, ball, &after), "palp_body_pose");
    check(touching > 60, "the hand hardly touched anything", frame);
    check(contacts > 60, "hardly any contacts", frame);
    check(ignored == 10, "bad joints went unnoticed", frame);
    check(after.position.x > before.position.x + 0.05f, "the ball was not pushed", frame);
}

/* The next address that a block may start at. */
static void *aligned(void *memory) {
    uintptr_t address = (uintptr_t)memory;
    uintptr_t past = address % PALP_BLOCK_ALIGNMENT;
    return (char *)memory + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

int main(void) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    size_t bytes = palp_memory_bytes(&room);
    void *memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    palp_world *world;
    uint64_t hash;
    check(memory != NULL, "no memory", 0);
    ok(palp_world_create(aligned(memory), bytes, &room, &world), "palp_world_create");
    run(world);
    ok(palp_state_hash(world, &hash), "palp_state_hash");
    printf("hash %016" PRIx64 "\n", hash);
    free(memory);
    return 0;
}
