/*
 * An arm with a ball for a shoulder reaches 150 mm into a wall, rests there, comes back, and reaches once
 * more with one step for chains a frame, then none. A neck without contact nods meanwhile, and a finger hangs on the hand.
 *
 * Prints the hash of the final state. Inputs use float + - * / alone, so that any language can make the
 * same ones. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <math.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 600
#define FREE_END 60
#define STILL_FROM 260
#define STILL_END 300
/* By the paper's method, until steps are scarce: then the tip is held, which asks for some in every frame. */
#define DESCENDS_FROM 300
#define FREE_AGAIN 460
#define SCARCE_FROM 480
#define NONE_FROM 580
#define JOINTS 5
#define HINGES 7
#define CORNERS 6
#define RADIUS 0.04f
#define WALL_Z (-0.55f)
#define SLOP 1e-4

/* Frame, then the angles that the tracker sees. */
typedef struct key {
    int frame;
    float angles[HINGES];
} key;

static const key keys[] = {
    {0, {0.9f, 0.0f, 0.0f, 1.0f, 0.0f, 0.3f, 0.0f}},
    {60, {0.85f, 0.1f, 0.1f, 1.2f, 0.2f, 0.25f, 0.1f}},
    {180, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}},
    {300, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}},
    {420, {0.85f, 0.1f, 0.1f, 1.2f, 0.2f, 0.25f, 0.1f}},
    {480, {0.85f, 0.1f, 0.1f, 1.2f, 0.2f, 0.25f, 0.1f}},
    {600, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}},
};

/* Hinges behind the ball: origin along Z of the link before, axis, range. */
typedef struct hinge {
    float z;
    palp_vec3 axis;
    float low, high;
} hinge;

static const hinge hinges[JOINTS - 1] = {
    {0.30f, {1.0f, 0.0f, 0.0f}, 0.0f, 2.4f},
    {0.00f, {0.0f, 0.0f, 1.0f}, -1.4f, 1.4f},
    {0.26f, {1.0f, 0.0f, 0.0f}, -1.2f, 1.2f},
    {0.00f, {0.0f, 1.0f, 0.0f}, -0.6f, 0.6f},
};

#define TWIST_LOW (-1.0f)
#define TWIST_HIGH 1.0f

static const palp_vec3 corners[CORNERS] = {
    {0.0f, 1.0f, 0.5f},  {-1.0f, 0.6f, 0.5f}, {-1.0f, -0.6f, 0.5f},
    {0.0f, -1.0f, 0.5f}, {1.0f, -0.6f, 0.5f}, {1.0f, 0.6f, 0.5f},
};
static const palp_vec3 visible = {0.0f, 0.0f, 1.0f};

/* Links with a capsule along Z, and its length. */
static const uint32_t links[3] = {2, 4, 6};
static const float lengths[3] = {0.30f, 0.26f, 0.10f};

static palp_world *world;
static palp_body_id body, wall;
static palp_chain_id arm, finger, neck;

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

/* ---- making the scene ---- */

static palp_joint shoulder(void) {
    palp_joint joint = PALP_JOINT_INIT;
    joint.kind = PALP_JOINT_BALL;
    /* Half a turn about Y: the limb's Z points forward. */
    joint.rest_pose.orientation.y = 1.0f;
    joint.rest_pose.orientation.w = 0.0f;
    joint.low_rad = TWIST_LOW;
    joint.high_rad = TWIST_HIGH;
    joint.cone_visible = visible;
    joint.cone_corner_count = CORNERS;
    memcpy(joint.cone_corners, corners, sizeof corners);
    ok(palp_cone_check(&visible, corners, CORNERS), "palp_cone_check");
    return joint;
}

static palp_joint hinge_of(const hinge *from) {
    palp_joint joint = PALP_JOINT_INIT;
    joint.rest_pose.position.z = from->z;
    joint.axis = from->axis;
    joint.low_rad = from->low;
    joint.high_rad = from->high;
    return joint;
}

static palp_chain_id add_chain(const palp_joint *joints, uint32_t count, palp_chain_id base,
                               uint32_t base_hinge) {
    palp_chain_def def = PALP_CHAIN_DEF_INIT;
    palp_chain_id chain;
    def.joints = joints;
    def.joint_count = count;
    def.base = base;
    def.base_hinge = base_hinge;
    ok(palp_chain_add(world, body, &def, &chain), "palp_chain_add");
    return chain;
}

static void add_arm(void) {
    const palp_chain_id root = {0, 0};
    palp_joint joints[JOINTS];
    palp_piece_def capsule = PALP_PIECE_DEF_INIT;
    palp_piece_id piece;
    int j;
    joints[0] = shoulder();
    for (j = 1; j < JOINTS; j++) {
        joints[j] = hinge_of(&hinges[j - 1]);
    }
    arm = add_chain(joints, JOINTS, root, 0);
    capsule.shape = PALP_SHAPE_SEGMENT;
    capsule.material = PALP_MATERIAL_HUMAN;
    capsule.radius_m = RADIUS;
    for (j = 0; j < 3; j++) {
        capsule.b.z = lengths[j];
        ok(palp_chain_add_piece(world, arm, links[j], &capsule, &piece), "palp_chain_add_piece");
    }
}

/* A finger without pieces on the hand, and a neck with a head that touches nothing. */
static void add_others(void) {
    const palp_chain_id root = {0, 0};
    palp_joint joint = PALP_JOINT_INIT;
    palp_piece_def head = PALP_PIECE_DEF_INIT;
    palp_piece_id piece;
    joint.rest_pose.position.z = 0.1f;
    finger = add_chain(&joint, 1, arm, HINGES - 1);
    joint.rest_pose.position.x = -0.2f;
    joint.rest_pose.position.y = 0.2f;
    joint.rest_pose.position.z = 0.0f;
    neck = add_chain(&joint, 1, root, 0);
    head.shape = PALP_SHAPE_POINT;
    head.radius_m = 0.1f;
    head.local_pose.position.y = 0.15f;
    ok(palp_chain_add_piece(world, neck, 0, &head, &piece), "palp_chain_add_piece");
    ok(palp_piece_set_groups(world, piece, 1, 2), "palp_piece_set_groups");
}

static void make_scene(void) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_piece_def box = PALP_PIECE_DEF_INIT;
    palp_piece_id piece;
    def.pose.position.z = WALL_Z - 0.1f;
    ok(palp_body_add(world, &def, &wall), "palp_body_add");
    box.shape = PALP_SHAPE_BOX;
    box.a.x = box.a.y = 2.0f;
    box.a.z = 0.1f;
    ok(palp_piece_add(world, wall, &box, &piece), "palp_piece_add");
    def.kind = PALP_KIND_DRIVEN;
    def.pose.position.z = 0.0f;
    ok(palp_body_add(world, &def, &body), "palp_body_add");
    add_arm();
    add_others();
    ok(palp_chain_place(world, arm, keys[0].angles, HINGES), "palp_chain_place");
}

/* ---- what the tracker sees ---- */

static void see_arm(int frame, float angles[HINGES]) {
    int k = 0, h;
    float share;
    while (frame > keys[k + 1].frame) {
        k++;
    }
    share = (float)(frame - keys[k].frame) / (float)(keys[k + 1].frame - keys[k].frame);
    for (h = 0; h < HINGES; h++) {
        const float from = keys[k].angles[h], to = keys[k + 1].angles[h];
        angles[h] = from + (to - from) * share;
    }
}

/* ---- forward kinematics of this file's own, in double ---- */

typedef struct vec {
    double x, y, z;
} vec;

typedef struct frame3 {
    double qx, qy, qz, qw;
    vec at;
} frame3;

static vec turned(const frame3 *f, double x, double y, double z) {
    const double tx = 2.0 * (f->qy * z - f->qz * y);
    const double ty = 2.0 * (f->qz * x - f->qx * z);
    const double tz = 2.0 * (f->qx * y - f->qy * x);
    vec v;
    v.x = x + f->qw * tx + (f->qy * tz - f->qz * ty);
    v.y = y + f->qw * ty + (f->qz * tx - f->qx * tz);
    v.z = z + f->qw * tz + (f->qx * ty - f->qy * tx);
    return v;
}

static void turn(frame3 *f, double x, double y, double z, double w) {
    const frame3 a = *f;
    f->qx = a.qw * x + a.qx * w + a.qy * z - a.qz * y;
    f->qy = a.qw * y - a.qx * z + a.qy * w + a.qz * x;
    f->qz = a.qw * z + a.qx * y - a.qy * x + a.qz * w;
    f->qw = a.qw * w - a.qx * x - a.qy * y - a.qz * z;
}

static void turn_about(frame3 *f, double x, double y, double z, double angle) {
    const double s = sin(0.5 * angle);
    turn(f, x * s, y * s, z * s, cos(0.5 * angle));
}

static void go(frame3 *f, double z) {
    const vec step = turned(f, 0.0, 0.0, z);
    f->at.x += step.x;
    f->at.y += step.y;
    f->at.z += step.z;
}

static void place_links(const float angles[HINGES], frame3 placed[HINGES]) {
    palp_pose root;
    frame3 f;
    int h;
    ok(palp_body_pose(world, body, &root), "palp_body_pose");
    f.qx = root.orientation.x;
    f.qy = root.orientation.y;
    f.qz = root.orientation.z;
    f.qw = root.orientation.w;
    f.at.x = root.position.x;
    f.at.y = root.position.y;
    f.at.z = root.position.z;
    turn(&f, 0.0, 1.0, 0.0, 0.0);
    for (h = 0; h < HINGES; h++) {
        if (h < 3) {
            turn_about(&f, h == 0, h == 1, h == 2, angles[h]);
        } else {
            const hinge *own = &hinges[h - 3];
            go(&f, own->z);
            turn_about(&f, own->axis.x, own->axis.y, own->axis.z, angles[h]);
        }
        placed[h] = f;
    }
}

/* ---- what must hold in every frame ---- */

static const float *angles_of(palp_chain_id chain, uint32_t expected, int frame) {
    const float *angles;
    uint32_t count;
    ok(palp_chain_angles(world, chain, &angles, &count), "palp_chain_angles");
    check(count == expected, "a wrong number of angles", frame);
    return angles;
}

static void check_limits(const float angles[HINGES], int frame) {
    const double a = angles[0], b = angles[1];
    const double limb[3] = {sin(b), -sin(a) * cos(b), cos(a) * cos(b)};
    int h, c;
    check(angles[2] >= TWIST_LOW && angles[2] <= TWIST_HIGH, "a twist beyond its range", frame);
    for (h = 3; h < HINGES; h++) {
        check(angles[h] >= hinges[h - 3].low && angles[h] <= hinges[h - 3].high,
              "an angle beyond its range", frame);
    }
    for (c = 0; c < CORNERS; c++) {
        const palp_vec3 p = corners[c], q = corners[(c + 1) % CORNERS];
        const double n[3] = {(double)p.y * q.z - (double)p.z * q.y,
                             (double)p.z * q.x - (double)p.x * q.z,
                             (double)p.x * q.y - (double)p.y * q.x};
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        const double inside = (limb[0] * n[0] + limb[1] * n[1] + limb[2] * n[2]) / length;
        check(inside > -1e-5, "the upper arm is outside its reach cone", frame);
    }
}

/* The links are where the angles put them, and in front of the wall: from the angles alone. */
static void check_links(const float angles[HINGES], int frame) {
    const palp_pose *poses;
    frame3 placed[HINGES];
    uint32_t count;
    int h, l;
    place_links(angles, placed);
    ok(palp_chain_link_poses(world, arm, &poses, &count), "palp_chain_link_poses");
    check(count == HINGES, "a wrong number of links", frame);
    for (h = 0; h < HINGES; h++) {
        const palp_vec3 at = poses[h].position;
        check(fabs(at.x - placed[h].at.x) < 1e-5 && fabs(at.y - placed[h].at.y) < 1e-5 &&
                  fabs(at.z - placed[h].at.z) < 1e-5,
              "a link is not where its angles say", frame);
    }
    for (l = 0; l < 3; l++) {
        frame3 end = placed[links[l]];
        check(end.at.z - RADIUS > WALL_Z - SLOP, "a link is in the wall", frame);
        go(&end, lengths[l]);
        check(end.at.z - RADIUS > WALL_Z - SLOP, "a link's end is in the wall", frame);
    }
}

static void check_frame(int frame) {
    palp_penetration_result found = PALP_PENETRATION_RESULT_INIT;
    const float *angles = angles_of(arm, HINGES, frame);
    check_limits(angles, frame);
    check_links(angles, frame);
    ok(palp_penetration(world, body, wall, &found), "palp_penetration");
    check(found.depth_m < SLOP, "the arm overlaps the wall", frame);
    if (frame >= STILL_FROM && frame < STILL_END) {
        check(found.depth_m == 0.0f && found.distance_m < 1e-4f, "the arm is not at the wall", frame);
    }
}

static void check_follows(palp_chain_id chain, const float *wanted, uint32_t count, int frame) {
    check(memcmp(angles_of(chain, count, frame), wanted, count * sizeof *wanted) == 0,
          "a joint free of contact lags", frame);
}

/* ---- the run ---- */

typedef struct tally {
    int bent, scarce, moved_while_still;
    uint32_t steps;
} tally;

static void step_frame(int frame, tally *seen) {
    const palp_pose root = PALP_POSE_IDENTITY;
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_frame_report report = PALP_FRAME_REPORT_INIT;
    palp_chain_state state = PALP_CHAIN_STATE_INIT;
    float angles[HINGES], before[HINGES];
    const float nod = 0.01f * (float)(frame % 50), curl = 0.02f * (float)(frame % 40);
    palp_status status;
    memcpy(before, angles_of(arm, HINGES, frame), sizeof before);
    see_arm(frame, angles);
    input.dt_s = 1.0f / 90.0f;
    if (frame == DESCENDS_FROM || frame == SCARCE_FROM) {
        palp_chain_options options = PALP_CHAIN_OPTIONS_DEFAULT;
        if (frame == DESCENDS_FROM) {
            options.method = PALP_METHOD_CYCLIC_DESCENT;
        } else {
            options.flags |= PALP_OPTION_HOLDS_TIP;
        }
        ok(palp_chain_set_options(world, arm, &options), "palp_chain_set_options");
    }
    input.reach_steps = frame < SCARCE_FROM ? UINT32_MAX : frame < NONE_FROM ? 1 : 0;
    ok(palp_body_set_target(world, body, &root), "palp_body_set_target");
    ok(palp_chain_set_angles(world, arm, angles, HINGES), "palp_chain_set_angles");
    ok(palp_chain_set_angles(world, neck, &nod, 1), "palp_chain_set_angles");
    ok(palp_chain_set_angles(world, finger, &curl, 1), "palp_chain_set_angles");
    status = palp_frame_step(world, &input, &report);
    ok(status, "palp_frame_step");
    ok(palp_chain_report(world, arm, &state), "palp_chain_report");
    check(state.steps == report.reach_steps, "steps are miscounted", frame);
    check((report.flags & PALP_FRAME_CUT_REACH) == 0 || frame >= SCARCE_FROM,
          "an unlimited budget was cut", frame);
    check_frame(frame);
    check_follows(neck, &nod, 1, frame);
    check_follows(finger, &curl, 1, frame);
    if (frame < FREE_END || (frame >= FREE_AGAIN && frame < SCARCE_FROM)) {
        check_follows(arm, angles, HINGES, frame);
        check(report.reach_steps == 0, "steps were spent in free air", frame);
    }
    seen->bent += (state.flags & PALP_CHAIN_BENT) != 0;
    seen->scarce += status == PALP_CUT_REACH;
    seen->steps += report.reach_steps;
    seen->moved_while_still +=
        frame >= STILL_FROM && frame < STILL_END &&
        memcmp(before, angles_of(arm, HINGES, frame), sizeof before) != 0;
}

/* Targets beyond the limits, links as a tracker sees them, and a controller in the hand. */
static void other_trackers(void) {
    const float wild[HINGES] = {-3.0f, 2.0f, 9.0f, -1.0f, 9.0f, -9.0f, 9.0f};
    const float rest[HINGES] = {0.0f, 0.0f, 0.0f, 0.4f, 0.0f, 0.0f, 0.0f};
    const float *targets;
    const palp_pose *poses;
    palp_pose seen[JOINTS];
    float before[HINGES], distance;
    uint32_t count;
    int h;
    ok(palp_chain_set_angles(world, arm, wild, HINGES), "palp_chain_set_angles");
    ok(palp_chain_target_angles(world, arm, &targets, &count), "palp_chain_target_angles");
    check(count == HINGES, "a wrong number of targets", FRAMES);
    check_limits(targets, FRAMES);

    ok(palp_chain_place(world, arm, keys[1].angles, HINGES), "palp_chain_place");
    memcpy(before, angles_of(arm, HINGES, FRAMES), sizeof before);
    ok(palp_chain_link_poses(world, arm, &poses, NULL), "palp_chain_link_poses");
    for (h = 2; h < HINGES; h++) {
        seen[h - 2] = poses[h];
    }
    ok(palp_chain_set_angles(world, arm, rest, HINGES), "palp_chain_set_angles");
    ok(palp_chain_set_link_poses(world, arm, seen, JOINTS), "palp_chain_set_link_poses");
    ok(palp_chain_target_angles(world, arm, &targets, NULL), "palp_chain_target_angles");
    for (h = 0; h < HINGES; h++) {
        check(fabs(targets[h] - before[h]) < 1e-4, "an angle was taken wrongly from poses", FRAMES);
    }
    ok(palp_chain_set_tip(world, arm, &seen[JOINTS - 1], rest, HINGES, &distance),
       "palp_chain_set_tip");
    check(distance < 2e-3f, "the tip was not reached", FRAMES);
    ok(palp_chain_target_angles(world, arm, &targets, NULL), "palp_chain_target_angles");
    check_limits(targets, FRAMES);
}

static void run(void) {
    tally seen = {0, 0, 0, 0};
    int frame;
    make_scene();
    for (frame = 0; frame < FRAMES; frame++) {
        step_frame(frame, &seen);
    }
    check(seen.bent > 60, "the arm hardly touched the wall", frame);
    check(seen.steps > 60, "hardly any steps for chains", frame);
    check(seen.scarce > 10, "scarce steps went unnoticed", frame);
    check(seen.moved_while_still == 0, "the arm creeps under a still tracker", frame);
    other_trackers();
}

/* A human arm and a finger, as the library knows them, on a body of their own. */
static void human_limbs(void) {
    palp_joint joints[PALP_LIMB_JOINTS_MAX];
    palp_chain_def def = PALP_CHAIN_DEF_INIT;
    palp_body_def body_def = PALP_BODY_DEF_INIT;
    palp_pose bones[3] = {PALP_POSE_IDENTITY, PALP_POSE_IDENTITY, PALP_POSE_IDENTITY};
    const palp_vec3 end = {0.0f, 0.0f, -0.09f};
    palp_body_id person;
    palp_chain_id limb, finger;
    palp_vec3 tip;
    const palp_pose *links;
    uint32_t count;
    body_def.kind = PALP_KIND_DRIVEN;
    body_def.pose.position.z = 20.0f;
    ok(palp_body_add(world, &body_def, &person), "palp_body_add");
    ok(palp_human_limb(PALP_LIMB_RIGHT_ARM, 1, 1.75f, joints, &count, &tip), "palp_human_limb");
    check(count == 5 && joints[0].kind == PALP_JOINT_BALL, "an arm is not an arm", 0);
    def.joints = joints;
    def.joint_count = count;
    ok(palp_chain_add(world, person, &def, &limb), "palp_chain_add");
    ok(palp_chain_link_poses(world, limb, &links, &count), "palp_chain_link_poses");
    check(count == 7, "an arm has seven hinges", 0);
    /* It hangs: the wrist is straight below the shoulder, by upper arm and forearm. */
    check(fabs(links[0].position.x - links[6].position.x) < 1e-4 &&
              fabs(links[0].position.y - links[6].position.y - 0.332 * 1.75) < 1e-3,
          "the arm does not hang", 0);
    bones[1].position.z = -0.04f;
    bones[2].position.z = -0.065f;
    ok(palp_human_finger(PALP_FINGER_INDEX, bones, &end, joints, &count), "palp_human_finger");
    def.joint_count = count;
    def.base = limb;
    def.base_hinge = 6;
    ok(palp_chain_add(world, person, &def, &finger), "palp_chain_add");
    check(count == 4, "a finger has four hinges", 0);
    check(palp_human_limb(6, 1, 1.75f, joints, &count, &tip) == PALP_BAD_ENUM, "no seventh limb", 0);
    check(palp_human_limb(0, 1, NAN, joints, &count, NULL) == PALP_BAD_NUMBER, "no height", 0);
    check(palp_human_limb(0, 1, 1.75f, NULL, &count, NULL) == PALP_NULL, "null joints", 0);
    check(palp_human_finger(5, bones, &end, joints, &count) == PALP_BAD_ENUM, "no sixth finger", 0);
    bones[1].orientation.w = NAN;
    check(palp_human_finger(1, bones, &end, joints, &count) == PALP_BAD_POSE, "a bad bone", 0);
}

/* The next address that a block may start at. */
static void *aligned(void *memory) {
    uintptr_t address = (uintptr_t)memory;
    uintptr_t past = address % PALP_BLOCK_ALIGNMENT;
    return (char *)memory + (past == 0 ? 0 : PALP_BLOCK_ALIGNMENT - past);
}

int main(void) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    palp_capacities marks = PALP_CAPACITIES_ROOM;
    size_t bytes = palp_memory_bytes(&room);
    void *memory = malloc(bytes + PALP_BLOCK_ALIGNMENT);
    uint64_t hash;
    check(memory != NULL, "no memory", 0);
    ok(palp_world_create(aligned(memory), bytes, &room, &world), "palp_world_create");
    run();
    ok(palp_high_water(world, &marks), "palp_high_water");
    check(marks.chains == 3 && marks.joints == HINGES + 2, "chains are miscounted", FRAMES);
    ok(palp_state_hash(world, &hash), "palp_state_hash");
    printf("hash %016" PRIx64 "\n", hash);
    human_limbs();
    free(memory);
    return 0;
}
