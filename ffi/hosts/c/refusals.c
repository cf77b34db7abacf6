/*
 * Everything that a host can get wrong through the header gets the status that the header says, and
 * leaves the world as it was. C99 and C++11. Exits with 1 at the first thing that is otherwise.
 */
#include "refusals.h"

static const palp_piece_id null_piece = {0, 0};
static palp_body_id fixed, loose, hand;
static palp_piece_id hand_piece;

static palp_capacities small_room(void) {
    palp_capacities room = PALP_CAPACITIES_ROOM;
    room.bodies = 4;
    room.pieces = 4;
    room.vertices = 24;
    room.pairs = 16;
    room.contacts = 16;
    room.materials = 1;
    room.chains = PALP_CHAINS_PER_BODY_MAX + 2;
    room.joints = PALP_CHAINS_PER_BODY_MAX + 4;
    return room;
}

static void make_world(void) {
    const palp_capacities room = small_room();
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_piece_id id;
    memory_bytes = palp_memory_bytes(&room);
    memory = (char *)aligned(malloc(memory_bytes + PALP_BLOCK_ALIGNMENT));
    FINE(palp_world_create(memory, memory_bytes, &room, &world));
    FINE(palp_body_add(world, &body, &fixed));
    body.kind = PALP_KIND_DYNAMIC;
    body.pose.position.y = 10.0f;
    FINE(palp_body_add(world, &body, &loose));
    body.kind = PALP_KIND_DRIVEN;
    body.pose.position.y = 20.0f;
    FINE(palp_body_add(world, &body, &hand));
    piece.shape = PALP_SHAPE_BOX;
    piece.a.x = piece.a.y = piece.a.z = 0.1f;
    FINE(palp_piece_add(world, fixed, &piece, &id));
    piece.shape = PALP_SHAPE_POINT;
    piece.radius_m = 0.1f;
    FINE(palp_piece_add(world, loose, &piece, &id));
    FINE(palp_piece_add(world, hand, &piece, &hand_piece));
}

static void creating(void) {
    palp_capacities room = small_room();
    palp_capacities wrong = room;
    palp_world *other = NULL;
    char *block = (char *)aligned(malloc(memory_bytes + 2 * PALP_BLOCK_ALIGNMENT));
    GIVES(PALP_NULL, palp_world_create(NULL, memory_bytes, &room, &other));
    GIVES(PALP_NULL, palp_world_create(block, memory_bytes, NULL, &other));
    GIVES(PALP_NULL, palp_world_create(block, memory_bytes, &room, NULL));
    GIVES(PALP_MISALIGNED, palp_world_create(block + 32, memory_bytes, &room, &other));
    GIVES(PALP_MISALIGNED,
          palp_world_create(block, memory_bytes, CROOKED(const palp_capacities *, block), &other));
    GIVES(PALP_MEMORY_TOO_SMALL, palp_world_create(block, memory_bytes - 1, &room, &other));
    GIVES(PALP_MEMORY_TOO_SMALL, palp_world_create(block, 0, &room, &other));
    wrong.bodies = UINT32_MAX;
    GIVES(PALP_CAPACITY_TOO_LARGE, palp_world_create(block, SIZE_MAX, &wrong, &other));
    TRUE(palp_memory_bytes(&wrong) == 0);
    TRUE(palp_memory_bytes(NULL) == 0);
    wrong = room;
    wrong.struct_size = 0;
    GIVES(PALP_BAD_STRUCT_SIZE, palp_world_create(block, memory_bytes, &wrong, &other));
    TRUE(palp_memory_bytes(&wrong) == 0);
    GIVES(PALP_BAD_STRUCT_SIZE, palp_capacities_room(&wrong));
    GIVES(PALP_NULL, palp_capacities_room(NULL));
    TRUE(other == NULL);
}

static void attaching(void) {
    palp_world *other = NULL;
    uint64_t hash;
    char *copy = (char *)aligned(malloc(memory_bytes + PALP_BLOCK_ALIGNMENT));
    memcpy(copy, memory, memory_bytes);
    GIVES(PALP_NULL, palp_world_attach(NULL, memory_bytes, &other));
    GIVES(PALP_NULL, palp_world_attach(copy, memory_bytes, NULL));
    GIVES(PALP_MISALIGNED, palp_world_attach(copy + 8, memory_bytes - 8, &other));
    GIVES(PALP_MEMORY_TOO_SMALL, palp_world_attach(copy, memory_bytes - 1, &other));
    GIVES(PALP_MEMORY_TOO_SMALL, palp_world_attach(copy, 8, &other));
    TRUE(other == NULL);
    FINE(palp_world_attach(copy, memory_bytes, &other));
    TRUE(hash_of(other) == hash_of(world));
    copy[20]++;
    GIVES(PALP_DAMAGED, palp_world_attach(copy, memory_bytes, &other));
    GIVES(PALP_DAMAGED, palp_state_hash(other, &hash));
    memset(copy, 0x5a, memory_bytes);
    GIVES(PALP_NOT_A_WORLD, palp_world_attach(copy, memory_bytes, &other));
    GIVES(PALP_NOT_A_WORLD, palp_state_hash((palp_world *)(void *)copy, &hash));
    GIVES(PALP_NULL, palp_state_hash(NULL, &hash));
    GIVES(PALP_MISALIGNED, palp_state_hash(CROOKED(palp_world *, copy), &hash));
}

/* Size of palp_body_def before couplings said how to push. */
#define WITHOUT_PUSH offsetof(palp_body_def, coupling.push)

static void bodies(void) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_body_def wrong;
    palp_body_id id = null_body, wrong_id;
    REFUSED(PALP_NULL, palp_body_add(NULL, &def, &id));
    REFUSED(PALP_NULL, palp_body_add(world, NULL, &id));
    REFUSED(PALP_NULL, palp_body_add(world, &def, NULL));
    REFUSED(PALP_MISALIGNED, palp_body_add(world, CROOKED(const palp_body_def *, &def), &id));
    for (wrong = def, wrong.struct_size = 0; wrong.struct_size < sizeof def; wrong.struct_size++) {
        if (wrong.struct_size == WITHOUT_PUSH) {
            continue;
        }
        REFUSED(PALP_BAD_STRUCT_SIZE, palp_body_add(world, &wrong, &id));
    }
    wrong.struct_size = UINT32_MAX;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_body_add(world, &wrong, &id));
    wrong = def;
    wrong.kind = 0;
    REFUSED(PALP_BAD_ENUM, palp_body_add(world, &wrong, &id));
    wrong.kind = 0x80000001u;
    REFUSED(PALP_BAD_ENUM, palp_body_add(world, &wrong, &id));
    wrong = def;
    wrong.pose.position.x = NAN;
    REFUSED(PALP_BAD_POSE, palp_body_add(world, &wrong, &id));
    wrong = def;
    wrong.pose.orientation.w = 0.0f;
    REFUSED(PALP_BAD_POSE, palp_body_add(world, &wrong, &id));
    wrong = def;
    wrong.kind = PALP_KIND_DRIVEN;
    wrong.coupling.mass_kg = 0.0f;
    REFUSED(PALP_BAD_COUPLING, palp_body_add(world, &wrong, &id));
    wrong.coupling = def.coupling;
    wrong.coupling.snap = 7;
    REFUSED(PALP_BAD_ENUM, palp_body_add(world, &wrong, &id));
    wrong.coupling = def.coupling;
    wrong.coupling.push = PALP_PUSH_WITH_MASS + 1;
    REFUSED(PALP_BAD_ENUM, palp_body_add(world, &wrong, &id));
    wrong = def;
    wrong.kind = PALP_KIND_HOSTED + 1;
    REFUSED(PALP_BAD_ENUM, palp_body_add(world, &wrong, &id));
    TRUE(id.index1 == 0);
    REFUSED(PALP_STALE_BODY, palp_body_remove(world, null_body));
    FINE(palp_body_add(world, &def, &id));
    FINE(palp_body_remove(world, id));
    REFUSED(PALP_STALE_BODY, palp_body_remove(world, id));
    FINE(palp_body_add(world, &def, &id));
    REFUSED(PALP_FULL_BODIES, palp_body_add(world, &def, &wrong_id));
    FINE(palp_body_remove(world, id));
}

static void placing(void) {
    const palp_pose good = PALP_POSE_IDENTITY;
    const palp_vec3 still = {0.0f, 0.0f, 0.0f};
    const palp_vec3 wild = {INFINITY, 0.0f, 0.0f};
    palp_pose wrong = good;
    palp_vec3 linear;
    palp_pose pose;
    float mass;
    wrong.orientation.x = -INFINITY;
    REFUSED(PALP_NULL, palp_body_place(world, hand, NULL));
    REFUSED(PALP_MISALIGNED, palp_body_place(world, hand, CROOKED(const palp_pose *, &good)));
    REFUSED(PALP_BAD_POSE, palp_body_place(world, hand, &wrong));
    REFUSED(PALP_STALE_BODY, palp_body_place(world, null_body, &good));
    REFUSED(PALP_BAD_POSE, palp_body_set_target(world, hand, &wrong));
    REFUSED(PALP_NULL, palp_body_set_target(world, hand, NULL));
    REFUSED(PALP_WRONG_KIND, palp_body_set_target(world, loose, &good));
    REFUSED(PALP_STALE_BODY, palp_body_set_target(world, null_body, &good));
    REFUSED(PALP_BAD_POSE, palp_body_set_piece_targets(world, hand, &wrong, 1));
    REFUSED(PALP_WRONG_COUNT, palp_body_set_piece_targets(world, hand, &good, 0));
    REFUSED(PALP_WRONG_COUNT, palp_body_set_piece_targets(world, hand, NULL, 0));
    REFUSED(PALP_NULL, palp_body_set_piece_targets(world, hand, NULL, 1));
    REFUSED(PALP_INSIDE_WORLD,
            palp_body_set_piece_targets(world, hand, (const palp_pose *)(void *)memory, 1));
    REFUSED(PALP_BAD_VELOCITY, palp_body_set_velocity(world, loose, &wild, &still));
    REFUSED(PALP_WRONG_KIND, palp_body_set_velocity(world, fixed, &still, &still));
    REFUSED(PALP_NULL, palp_body_set_velocity(world, loose, &still, NULL));
    REFUSED(PALP_WRONG_KIND, palp_body_velocity(world, hand, &linear, NULL));
    REFUSED(PALP_WRONG_KIND, palp_body_mass(world, hand, &mass));
    REFUSED(PALP_NULL, palp_body_mass(world, loose, NULL));
    REFUSED(PALP_NULL, palp_body_pose(world, hand, NULL));
    REFUSED(PALP_STALE_BODY, palp_body_pose(world, null_body, &pose));
    REFUSED(PALP_NOT_FINITE, palp_gravity_set(world, &wild));
    FINE(palp_body_velocity(world, loose, NULL, NULL));
}

static void pieces(void) {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_def wrong;
    palp_piece_id id = null_piece;
    palp_pose pose;
    float flat[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    def.shape = PALP_SHAPE_POINT;
    def.radius_m = 0.1f;
    REFUSED(PALP_NULL, palp_piece_add(world, fixed, NULL, &id));
    REFUSED(PALP_NULL, palp_piece_add(world, fixed, &def, NULL));
    REFUSED(PALP_STALE_BODY, palp_piece_add(world, null_body, &def, &id));
#define WRONG(status, change)                                                                      \
    wrong = def;                                                                                   \
    change;                                                                                        \
    REFUSED(status, palp_piece_add(world, fixed, &wrong, &id))
    WRONG(PALP_BAD_STRUCT_SIZE, wrong.struct_size--);
    WRONG(PALP_BAD_ENUM, wrong.shape = 0);
    WRONG(PALP_BAD_ENUM, wrong.shape = 99);
    WRONG(PALP_NOT_FINITE, wrong.radius_m = NAN);
    WRONG(PALP_BAD_NUMBER, wrong.radius_m = -1.0f);
    WRONG(PALP_DEGENERATE, wrong.radius_m = 0.0f);
    WRONG(PALP_BAD_NUMBER, wrong.density_kg_m3 = 0.0f);
    WRONG(PALP_UNKNOWN_MATERIAL, wrong.material = 3);
    WRONG(PALP_BAD_POSE, wrong.local_pose.position.z = NAN);
    def.shape = PALP_SHAPE_HULL;
    def.points = flat[0];
    def.point_count = 4;
    WRONG(PALP_NULL, wrong.points = NULL);
    WRONG(PALP_MISALIGNED, wrong.points = CROOKED(const float *, flat));
    WRONG(PALP_BAD_STRIDE, wrong.point_stride = 8);
    WRONG(PALP_BAD_STRIDE, wrong.point_stride = 13);
    WRONG(PALP_TOO_FEW_POINTS, wrong.point_count = 0);
    WRONG(PALP_TOO_MANY_POINTS, wrong.point_count = PALP_POINTS_MAX + 1);
    WRONG(PALP_TOO_MANY_POINTS, wrong.point_count = UINT32_MAX);
    WRONG(PALP_DEGENERATE, wrong.radius_m = 0.0f);
    def.shape = PALP_SHAPE_BOX;
    def.a.x = def.a.y = def.a.z = 0.1f;
    FINE(palp_piece_add(world, fixed, &def, &id));
    REFUSED(PALP_FULL_PIECES, palp_piece_add(world, fixed, &def, &id));
    FINE(palp_piece_remove(world, id));
    REFUSED(PALP_STALE_PIECE, palp_piece_remove(world, id));
    REFUSED(PALP_STALE_PIECE, palp_piece_remove(world, null_piece));
    REFUSED(PALP_STALE_PIECE, palp_piece_pose(world, id, &pose));
    REFUSED(PALP_NULL, palp_piece_pose(world, hand_piece, NULL));
    REFUSED(PALP_NULL, palp_piece_poses(world, NULL, NULL));
    REFUSED(PALP_NULL, palp_contacts(world, NULL, NULL));
}

static void full_vertices(void) {
    float points[16][3];
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_id id;
    int i;
    for (i = 0; i < 16; i++) {
        points[i][0] = (float)(i % 4 * (i % 4));
        points[i][1] = (float)(i / 4 * (i / 4));
        points[i][2] = (float)(i % 4 + i / 4) - 0.1f * (float)(i * i % 7);
    }
    def.shape = PALP_SHAPE_BOX;
    def.a.x = def.a.y = def.a.z = 0.1f;
    FINE(palp_piece_add(world, fixed, &def, &id));
    FINE(palp_piece_remove(world, id));
    def.shape = PALP_SHAPE_HULL;
    def.points = points[0];
    def.point_count = 16;
    def.point_stride = sizeof points[0];
    i = (int)palp_piece_add(world, fixed, &def, &id);
    TRUE(i == PALP_OK || i == PALP_FULL_VERTICES);
    if (i == PALP_OK) {
        FINE(palp_piece_remove(world, id));
    }
}

static void materials(void) {
    uint32_t material = 99;
    REFUSED(PALP_NULL, palp_material_add(world, NULL));
    FINE(palp_material_add(world, &material));
    TRUE(material == 3);
    REFUSED(PALP_FULL_MATERIALS, palp_material_add(world, &material));
    REFUSED(PALP_UNKNOWN_MATERIAL, palp_surface_set(world, 4, 0, 0.5f, 0.5f));
    REFUSED(PALP_BAD_SURFACE, palp_surface_set(world, 3, 0, 1.5f, 0.5f));
    REFUSED(PALP_BAD_SURFACE, palp_surface_set(world, 3, 0, 0.5f, NAN));
    FINE(palp_surface_set(world, material, PALP_MATERIAL_WOOD, 0.5f, 0.5f));
}

static void queries(void) {
    const palp_pose good = PALP_POSE_IDENTITY;
    palp_pose wrong = good;
    palp_penetration_result result = PALP_PENETRATION_RESULT_INIT;
    const palp_penetration_result untouched = PALP_PENETRATION_RESULT_INIT;
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_body_id gone;
    FINE(palp_body_add(world, &def, &gone));
    FINE(palp_body_remove(world, gone));
    wrong.position.y = NAN;
    REFUSED(PALP_NULL, palp_penetration(NULL, hand, fixed, &result));
    REFUSED(PALP_NULL, palp_penetration(world, hand, fixed, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_penetration(world, hand, fixed, CROOKED(palp_penetration_result *, &result)));
    REFUSED(PALP_STALE_BODY, palp_penetration(world, null_body, fixed, &result));
    REFUSED(PALP_STALE_BODY, palp_penetration(world, hand, gone, &result));
    REFUSED(PALP_SAME_BODY, palp_penetration(world, hand, hand, &result));
    REFUSED(PALP_NULL, palp_penetration_at(world, hand, NULL, fixed, &good, &result));
    REFUSED(PALP_NULL, palp_penetration_at(world, hand, &good, fixed, NULL, &result));
    REFUSED(PALP_BAD_POSE, palp_penetration_at(world, hand, &wrong, fixed, &good, &result));
    REFUSED(PALP_BAD_POSE, palp_penetration_at(world, hand, &good, fixed, &wrong, &result));
    REFUSED(PALP_STALE_BODY, palp_penetration_at(world, gone, &good, fixed, &good, &result));
    REFUSED(PALP_SAME_BODY, palp_penetration_at(world, hand, &good, hand, &good, &result));
    TRUE(memcmp(&result, &untouched, sizeof result) == 0);
    result.struct_size--;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_penetration(world, hand, fixed, &result));
    result.struct_size = sizeof result;
    GIVES(PALP_OK, palp_penetration(world, hand, fixed, &result));
    TRUE(result.depth_m == 0.0f && result.distance_m > 19.79f && result.distance_m < 19.81f);
}

static void frames(void) {
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_frame_report report = PALP_FRAME_REPORT_INIT;
    palp_frame_report untouched = PALP_FRAME_REPORT_INIT;
    palp_driven_state state = PALP_DRIVEN_STATE_INIT;
    REFUSED(PALP_NULL, palp_frame_step(world, NULL, &report));
    REFUSED(PALP_NULL, palp_frame_step(NULL, &input, &report));
    report.struct_size = 4;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_frame_step(world, &input, &report));
    report = untouched;
    input.struct_size = 0;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_frame_step(world, &input, &report));
    TRUE(memcmp(&report, &untouched, sizeof report) == 0);
    input.struct_size = sizeof input;
    input.dt_s = 0.0f;
    REFUSED(PALP_BAD_TIME_STEP, palp_frame_step(world, &input, &report));
    input.dt_s = -1.0f;
    REFUSED(PALP_BAD_TIME_STEP, palp_frame_step(world, &input, &report));
    input.dt_s = NAN;
    REFUSED(PALP_BAD_TIME_STEP, palp_frame_step(world, &input, &report));
    input.dt_s = 5.0f;
    GIVES(PALP_TIME_STEP_CLAMPED, palp_frame_step(world, &input, NULL));
    REFUSED(PALP_WRONG_KIND, palp_driven_report(world, loose, &state));
    state.struct_size = 1;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_driven_report(world, hand, &state));
}

static void states(void) {
    size_t bytes = 0, written = 0;
    palp_capacities marks = PALP_CAPACITIES_ROOM;
    char *saved;
    uint64_t before;
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    FINE(palp_state_bytes(world, &bytes));
    saved = (char *)malloc(bytes + 1);
    REFUSED(PALP_NULL, palp_state_bytes(world, NULL));
    REFUSED(PALP_NULL, palp_state_hash(world, NULL));
    REFUSED(PALP_NULL, palp_state_save(world, NULL, bytes, &written));
    REFUSED(PALP_BUFFER_TOO_SMALL, palp_state_save(world, saved, bytes - 1, &written));
    REFUSED(PALP_INSIDE_WORLD, palp_state_save(world, memory, bytes, &written));
    FINE(palp_state_save(world, saved + 1, bytes, &written));
    TRUE(written == bytes);
    before = hash_of(world);
    palp_frame_step(world, &input, NULL);
    TRUE(hash_of(world) != before);
    REFUSED(PALP_BUFFER_TOO_SMALL, palp_state_load(world, saved + 1, bytes - 1));
    REFUSED(PALP_DAMAGED, palp_state_load(world, saved, bytes));
    REFUSED(PALP_DAMAGED, palp_state_load(world, saved, 0));
    REFUSED(PALP_INSIDE_WORLD, palp_state_load(world, memory, bytes));
    FINE(palp_state_load(world, saved + 1, bytes));
    TRUE(hash_of(world) == before);
    FINE(palp_high_water(world, &marks));
    TRUE(marks.bodies == 4 && marks.pieces == 4 && marks.materials == 1);
}

typedef struct joint_location {
    uint64_t flags;
    palp_pose pose;
    float radius;
} joint_location;

static joint_location joints[PALP_HAND_JOINTS];

static palp_status see(uint32_t count, const uint32_t *piece_joints, uint32_t *kept) {
    return palp_hand_set_joints(world, hand, joints, 0, NULL, piece_joints, count, 0.5f, kept);
}

static void good_joints(void) {
    const palp_pose good = PALP_POSE_IDENTITY;
    uint32_t j;
    for (j = 0; j < PALP_HAND_JOINTS; j++) {
        joints[j].flags = 3;
        joints[j].pose = good;
        joints[j].pose.position.y = 20.0f;
    }
}

static void hands(void) {
    const uint32_t tip = 10, unknown = PALP_HAND_JOINTS;
    const palp_pose bad = {{NAN, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_pose pose;
    uint32_t kept = 99;
    good_joints();
    REFUSED(PALP_NULL, palp_hand_set_joints(world, hand, NULL, 0, NULL, &tip, 1, 0.5f, NULL));
    REFUSED(PALP_NULL, see(1, NULL, NULL));
    REFUSED(PALP_BAD_STRIDE,
            palp_hand_set_joints(world, hand, joints, 39, NULL, &tip, 1, 0.5f, NULL));
    REFUSED(PALP_WRONG_COUNT, see(0, NULL, NULL));
    REFUSED(PALP_UNKNOWN_JOINT, see(1, &unknown, NULL));
    REFUSED(PALP_BAD_POSE, palp_hand_set_joints(world, hand, joints, 0, &bad, &tip, 1, 0.5f, NULL));
    REFUSED(PALP_BAD_NUMBER, palp_hand_set_joints(world, hand, joints, 0, NULL, &tip, 1, 0.0f, NULL));
    REFUSED(PALP_BAD_NUMBER, palp_hand_set_joints(world, hand, joints, 0, NULL, &tip, 1, NAN, NULL));
    REFUSED(PALP_WRONG_KIND,
            palp_hand_set_joints(world, loose, joints, 0, NULL, &tip, 1, 0.5f, NULL));
    REFUSED(PALP_STALE_BODY,
            palp_hand_set_joints(world, null_body, joints, 0, NULL, &tip, 1, 0.5f, NULL));
    joints[tip].pose.position.x = 0.125f;
    FINE(see(1, &tip, &kept));
    TRUE(kept == 0);
    FINE(palp_frame_step(world, &input, NULL));
    FINE(palp_piece_pose(world, hand_piece, &pose));
    TRUE(pose.position.x == 0.125f && pose.position.y == 20.0f);

    joints[tip].pose.position.x = 0.25f;
    joints[tip].flags = 1;
    GIVES(PALP_JOINTS_IGNORED, see(1, &tip, &kept));
    TRUE(kept == 1);
    joints[tip].flags = 3;
    joints[tip].pose.orientation.w = NAN;
    GIVES(PALP_JOINTS_IGNORED, see(1, &tip, NULL));
    joints[tip].pose.orientation.w = 0.0f;
    GIVES(PALP_JOINTS_IGNORED, see(1, &tip, NULL));
    joints[tip].pose.orientation.w = -3.0f;
    joints[tip].pose.position.x = 0.75f;
    GIVES(PALP_JOINTS_IGNORED, see(1, &tip, NULL));
    FINE(palp_frame_step(world, &input, NULL));
    FINE(palp_piece_pose(world, hand_piece, &pose));
    TRUE(pose.position.x == 0.125f);

    joints[tip].pose.position.x = 0.25f;
    joints[1].flags = 2;
    REFUSED(PALP_TRACKING_LOST, see(1, &tip, &kept));
    TRUE(kept == 1);
    joints[1].flags = UINT64_MAX;
    joints[1].pose.position.z = INFINITY;
    REFUSED(PALP_TRACKING_LOST, see(1, &tip, NULL));
}

#define ANGLES 4

static const palp_chain_id null_chain = {0, 0};
static palp_chain_id arm, gone_chain;

/* A ball with a reach cone, and a hinge. */
static void good_joints_of_a_chain(palp_joint made[2]) {
    const palp_joint joint = PALP_JOINT_INIT;
    const palp_vec3 corners[4] = {
        {1.0f, 0.0f, 1.0f}, {0.0f, 1.0f, 1.0f}, {-1.0f, 0.0f, 1.0f}, {0.0f, -1.0f, 1.0f}};
    made[0] = made[1] = joint;
    made[0].kind = PALP_JOINT_BALL;
    made[0].cone_corner_count = 4;
    memcpy(made[0].cone_corners, corners, sizeof corners);
    made[1].rest_pose.position.z = 0.3f;
    made[1].low_rad = -1.0f;
    made[1].high_rad = 2.0f;
}

static void cones(void) {
    palp_joint made[2];
    palp_vec3 corners[PALP_CONE_CORNERS_MAX + 1], visible;
    uint32_t i;
    good_joints_of_a_chain(made);
    visible = made[0].cone_visible;
    memcpy(corners, made[0].cone_corners, sizeof made[0].cone_corners);
    FINE(palp_cone_check(&visible, corners, 4));
    GIVES(PALP_NULL, palp_cone_check(NULL, corners, 4));
    GIVES(PALP_NULL, palp_cone_check(&visible, NULL, 4));
    GIVES(PALP_MISALIGNED, palp_cone_check(&visible, CROOKED(const palp_vec3 *, corners), 4));
    GIVES(PALP_MISALIGNED, palp_cone_check(CROOKED(const palp_vec3 *, &visible), corners, 4));
    GIVES(PALP_CONE_TOO_FEW_CORNERS, palp_cone_check(&visible, NULL, 0));
    GIVES(PALP_CONE_TOO_FEW_CORNERS, palp_cone_check(&visible, corners, 2));
    GIVES(PALP_CONE_TOO_MANY_CORNERS,
          palp_cone_check(&visible, corners, PALP_CONE_CORNERS_MAX + 1));
    GIVES(PALP_CONE_TOO_MANY_CORNERS, palp_cone_check(&visible, corners, UINT32_MAX));
    corners[1].y = NAN;
    GIVES(PALP_CONE_NO_DIRECTION, palp_cone_check(&visible, corners, 4));
    corners[1] = corners[0];
    GIVES(PALP_CONE_BAD_EDGE, palp_cone_check(&visible, corners, 4));
    corners[1] = made[0].cone_corners[1];
    visible.x = 2.0f;
    GIVES(PALP_CONE_NOT_VISIBLE, palp_cone_check(&visible, corners, 4));
    visible = made[0].cone_visible;
    for (i = 0; i < 8; i++) {
        corners[i] = made[0].cone_corners[i % 4];
    }
    GIVES(PALP_CONE_BAD_WINDING, palp_cone_check(&visible, corners, 8));
}

static void adding_chains(void) {
    palp_joint made[PALP_CHAIN_HINGES_MAX + 1], good[2];
    palp_chain_def def = PALP_CHAIN_DEF_INIT, wrong = PALP_CHAIN_DEF_INIT;
    palp_chain_id id = null_chain, other;
    uint32_t i;
    good_joints_of_a_chain(good);
    memcpy(made, good, sizeof good);
    def.joints = made;
    def.joint_count = 2;
    REFUSED(PALP_NULL, palp_chain_add(NULL, hand, &def, &id));
    REFUSED(PALP_NULL, palp_chain_add(world, hand, NULL, &id));
    REFUSED(PALP_NULL, palp_chain_add(world, hand, &def, NULL));
    REFUSED(PALP_MISALIGNED, palp_chain_add(world, hand, CROOKED(palp_chain_def *, &def), &id));
    REFUSED(PALP_MISALIGNED, palp_chain_add(world, hand, &def, CROOKED(palp_chain_id *, &id)));
    REFUSED(PALP_STALE_BODY, palp_chain_add(world, null_body, &def, &id));
    REFUSED(PALP_WRONG_KIND, palp_chain_add(world, fixed, &def, &id));
    REFUSED(PALP_WRONG_KIND, palp_chain_add(world, loose, &def, &id));
#define WRONG_CHAIN(status, change)                                                                \
    wrong = def;                                                                                   \
    change;                                                                                        \
    REFUSED(status, palp_chain_add(world, hand, &wrong, &id))
    WRONG_CHAIN(PALP_BAD_STRUCT_SIZE, wrong.struct_size--);
    WRONG_CHAIN(PALP_BAD_STRUCT_SIZE, wrong.struct_size = 0);
    WRONG_CHAIN(PALP_WRONG_COUNT, wrong.joint_count = 0);
    WRONG_CHAIN(PALP_WRONG_COUNT, wrong.joint_count = PALP_CHAIN_HINGES_MAX + 1);
    WRONG_CHAIN(PALP_WRONG_COUNT, wrong.joint_count = UINT32_MAX);
    WRONG_CHAIN(PALP_NULL, wrong.joints = NULL);
    WRONG_CHAIN(PALP_MISALIGNED, wrong.joints = CROOKED(const palp_joint *, made));
    WRONG_CHAIN(PALP_BAD_STRIDE, wrong.joint_stride = sizeof(palp_joint) - 4);
    WRONG_CHAIN(PALP_BAD_STRIDE, wrong.joint_stride = sizeof(palp_joint) + 2);
    WRONG_CHAIN(PALP_BAD_BASE, wrong.base.index1 = 1);
    WRONG_CHAIN(PALP_BAD_BASE, wrong.base.generation = 1);
    WRONG_CHAIN(PALP_BAD_OPTIONS, wrong.options.method = 2);
    WRONG_CHAIN(PALP_BAD_OPTIONS, wrong.options.flags = 32);
    WRONG_CHAIN(PALP_BAD_OPTIONS, wrong.options.attraction_s = -1.0f);
    WRONG_CHAIN(PALP_BAD_OPTIONS, wrong.options.tip.z = INFINITY);
#define WRONG_JOINT(status, number, change)                                                        \
    memcpy(made, good, sizeof good);                                                               \
    made[number].change;                                                                           \
    REFUSED(status, palp_chain_add(world, hand, &def, &id))
    WRONG_JOINT(PALP_BAD_STRUCT_SIZE, 0, struct_size = 0);
    WRONG_JOINT(PALP_BAD_STRUCT_SIZE, 1, struct_size--);
    WRONG_JOINT(PALP_BAD_STRUCT_SIZE, 1, struct_size += 4);
    WRONG_JOINT(PALP_BAD_STRUCT_SIZE, 1, struct_size = UINT32_MAX);
    WRONG_JOINT(PALP_BAD_ENUM, 1, kind = 0);
    WRONG_JOINT(PALP_BAD_ENUM, 0, kind = 3);
    WRONG_JOINT(PALP_BAD_POSE, 0, rest_pose.position.x = NAN);
    WRONG_JOINT(PALP_BAD_POSE, 1, rest_pose.orientation.w = 0.0f);
    WRONG_JOINT(PALP_BAD_AXIS, 1, axis.x = 0.0f);
    WRONG_JOINT(PALP_BAD_AXIS, 1, axis.y = NAN);
    WRONG_JOINT(PALP_BAD_RANGE, 1, low_rad = NAN);
    WRONG_JOINT(PALP_BAD_RANGE, 1, low_rad = 2.5f);
    WRONG_JOINT(PALP_BAD_RANGE, 0, high_rad = 7.0f);
    WRONG_JOINT(PALP_CONE_TOO_FEW_CORNERS, 0, cone_corner_count = 2);
    WRONG_JOINT(PALP_CONE_TOO_MANY_CORNERS, 0, cone_corner_count = PALP_CONE_CORNERS_MAX + 1);
    WRONG_JOINT(PALP_CONE_TOO_MANY_CORNERS, 0, cone_corner_count = UINT32_MAX);
    WRONG_JOINT(PALP_CONE_NO_DIRECTION, 0, cone_visible.x = NAN);
    WRONG_JOINT(PALP_CONE_NO_DIRECTION, 0, cone_corners[3].y = 0.0f; made[0].cone_corners[3].z = 0.0f);
    WRONG_JOINT(PALP_CONE_NOT_VISIBLE, 0, cone_visible.x = 2.0f);
    WRONG_CHAIN(PALP_INSIDE_WORLD, wrong.joints = (const palp_joint *)(void *)memory);
    TRUE(id.index1 == 0);
    memcpy(made, good, sizeof good);
    FINE(palp_chain_add(world, hand, &def, &arm));
    WRONG_CHAIN(PALP_BAD_BASE, (wrong.base = arm, wrong.base_hinge = ANGLES));
    WRONG_CHAIN(PALP_BAD_BASE, (wrong.base = arm, wrong.base_hinge = UINT32_MAX));
    for (i = 0; i < PALP_CHAIN_HINGES_MAX + 1; i++) {
        made[i] = good[1];
    }
    made[0] = good[0];
    WRONG_CHAIN(PALP_WRONG_COUNT, wrong.joint_count = PALP_CHAIN_HINGES_MAX - 1);
    def.base = arm;
    def.base_hinge = ANGLES - 1;
    FINE(palp_chain_add(world, hand, &def, &other));
    REFUSED(PALP_CHAIN_IN_USE, palp_chain_remove(world, arm));
    FINE(palp_chain_remove(world, other));
    gone_chain = other;
    REFUSED(PALP_STALE_CHAIN, palp_chain_remove(world, gone_chain));
    REFUSED(PALP_STALE_CHAIN, palp_chain_remove(world, null_chain));
    REFUSED(PALP_NULL, palp_chain_remove(NULL, arm));
}

static void full_chains(void) {
    palp_joint made[PALP_CHAIN_HINGES_MAX];
    const palp_joint joint = PALP_JOINT_INIT;
    palp_chain_def def = PALP_CHAIN_DEF_INIT;
    palp_chain_id ids[PALP_CHAINS_PER_BODY_MAX], id;
    palp_body_def body_def = PALP_BODY_DEF_INIT;
    palp_body_id body;
    uint32_t i;
    for (i = 0; i < PALP_CHAIN_HINGES_MAX; i++) {
        made[i] = joint;
    }
    def.joints = made;
    body_def.kind = PALP_KIND_DRIVEN;
    FINE(palp_body_add(world, &body_def, &body));
    def.joint_count = PALP_CHAIN_HINGES_MAX;
    FINE(palp_chain_add(world, body, &def, &ids[0]));
    FINE(palp_chain_add(world, body, &def, &ids[1]));
    REFUSED(PALP_FULL_JOINTS, palp_chain_add(world, body, &def, &id));
    FINE(palp_chain_remove(world, ids[0]));
    FINE(palp_chain_remove(world, ids[1]));
    def.joint_count = 1;
    for (i = 0; i < PALP_CHAINS_PER_BODY_MAX; i++) {
        FINE(palp_chain_add(world, body, &def, &ids[i]));
    }
    /* The arm has four of the joints. */
    REFUSED(PALP_FULL_JOINTS, palp_chain_add(world, body, &def, &id));
    FINE(palp_chain_remove(world, arm));
    gone_chain = arm;
    REFUSED(PALP_TOO_MANY_CHAINS, palp_chain_add(world, body, &def, &id));
    FINE(palp_chain_add(world, hand, &def, &id));
    FINE(palp_chain_add(world, hand, &def, &id));
    REFUSED(PALP_FULL_CHAINS, palp_chain_add(world, hand, &def, &id));
    FINE(palp_body_remove(world, body));
    REFUSED(PALP_STALE_CHAIN, palp_chain_remove(world, ids[7]));
    FINE(palp_chain_remove(world, id));
    good_joints_of_a_chain(made);
    def.joint_count = 2;
    FINE(palp_chain_add(world, hand, &def, &arm));
}

static void pieces_of_chains(void) {
    palp_piece_def def = PALP_PIECE_DEF_INIT, wrong;
    palp_piece_id id = null_piece;
    def.shape = PALP_SHAPE_POINT;
    def.radius_m = 0.1f;
    wrong = def;
    REFUSED(PALP_NULL, palp_chain_add_piece(NULL, arm, 0, &def, &id));
    REFUSED(PALP_NULL, palp_chain_add_piece(world, arm, 0, NULL, &id));
    REFUSED(PALP_NULL, palp_chain_add_piece(world, arm, 0, &def, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_chain_add_piece(world, arm, 0, CROOKED(const palp_piece_def *, &def), &id));
    REFUSED(PALP_STALE_CHAIN, palp_chain_add_piece(world, null_chain, 0, &def, &id));
    REFUSED(PALP_STALE_CHAIN, palp_chain_add_piece(world, gone_chain, 0, &def, &id));
    REFUSED(PALP_UNKNOWN_JOINT, palp_chain_add_piece(world, arm, ANGLES, &def, &id));
    REFUSED(PALP_UNKNOWN_JOINT, palp_chain_add_piece(world, arm, UINT32_MAX, &def, &id));
    wrong.struct_size--;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_chain_add_piece(world, arm, 0, &wrong, &id));
    wrong = def;
    wrong.radius_m = 0.0f;
    REFUSED(PALP_DEGENERATE, palp_chain_add_piece(world, arm, 0, &wrong, &id));
    FINE(palp_chain_add_piece(world, arm, ANGLES - 1, &def, &id));
    REFUSED(PALP_FULL_PIECES, palp_chain_add_piece(world, arm, 0, &def, &id));
    FINE(palp_piece_set_groups(world, id, 1, 2));
    FINE(palp_piece_remove(world, id));
    REFUSED(PALP_STALE_PIECE, palp_piece_set_groups(world, id, 1, 2));
    REFUSED(PALP_STALE_PIECE, palp_piece_set_groups(world, null_piece, 1, 2));
    REFUSED(PALP_NULL, palp_piece_set_groups(NULL, hand_piece, 1, 2));
}

static void driving_chains(void) {
    float angles[ANGLES] = {0.1f, 0.1f, 0.1f, 0.1f}, wild[ANGLES], distance = -1.0f;
    const palp_pose good = PALP_POSE_IDENTITY;
    palp_pose poses[2], bad = good;
    palp_chain_options options = PALP_CHAIN_OPTIONS_DEFAULT;
    int i;
    poses[0] = poses[1] = good;
    bad.position.x = NAN;
    memcpy(wild, angles, sizeof angles);
    wild[ANGLES - 1] = NAN;
#define DRIVING(call)                                                                              \
    REFUSED(PALP_NULL, call(NULL, arm, angles, ANGLES));                                           \
    REFUSED(PALP_NULL, call(world, arm, NULL, ANGLES));                                            \
    REFUSED(PALP_MISALIGNED, call(world, arm, CROOKED(const float *, angles), ANGLES));            \
    REFUSED(PALP_INSIDE_WORLD, call(world, arm, (const float *)(void *)memory, ANGLES));           \
    REFUSED(PALP_STALE_CHAIN, call(world, null_chain, angles, ANGLES));                            \
    REFUSED(PALP_STALE_CHAIN, call(world, gone_chain, angles, ANGLES));                            \
    REFUSED(PALP_WRONG_COUNT, call(world, arm, angles, ANGLES - 1));                               \
    REFUSED(PALP_WRONG_COUNT, call(world, arm, NULL, 0));                                          \
    REFUSED(PALP_NOT_FINITE, call(world, arm, wild, ANGLES))
    DRIVING(palp_chain_set_angles);
    DRIVING(palp_chain_place);
    REFUSED(PALP_NULL, palp_chain_set_link_poses(NULL, arm, poses, 2));
    REFUSED(PALP_NULL, palp_chain_set_link_poses(world, arm, NULL, 2));
    REFUSED(PALP_MISALIGNED, palp_chain_set_link_poses(world, arm, CROOKED(palp_pose *, poses), 2));
    REFUSED(PALP_INSIDE_WORLD,
            palp_chain_set_link_poses(world, arm, (const palp_pose *)(void *)memory, 2));
    REFUSED(PALP_STALE_CHAIN, palp_chain_set_link_poses(world, gone_chain, poses, 2));
    REFUSED(PALP_WRONG_COUNT, palp_chain_set_link_poses(world, arm, poses, 1));
    poses[1].orientation.w = 0.0f;
    REFUSED(PALP_BAD_POSE, palp_chain_set_link_poses(world, arm, poses, 2));
    REFUSED(PALP_NULL, palp_chain_set_tip(NULL, arm, &good, angles, ANGLES, NULL));
    REFUSED(PALP_NULL, palp_chain_set_tip(world, arm, NULL, angles, ANGLES, NULL));
    REFUSED(PALP_NULL, palp_chain_set_tip(world, arm, &good, NULL, ANGLES, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_chain_set_tip(world, arm, &good, angles, ANGLES, CROOKED(float *, &distance)));
    REFUSED(PALP_INSIDE_WORLD,
            palp_chain_set_tip(world, arm, &good, (const float *)(void *)memory, ANGLES, NULL));
    REFUSED(PALP_STALE_CHAIN, palp_chain_set_tip(world, gone_chain, &good, angles, ANGLES, NULL));
    REFUSED(PALP_WRONG_COUNT, palp_chain_set_tip(world, arm, &good, angles, 1, NULL));
    REFUSED(PALP_NOT_FINITE, palp_chain_set_tip(world, arm, &good, wild, ANGLES, NULL));
    REFUSED(PALP_BAD_POSE, palp_chain_set_tip(world, arm, &bad, angles, ANGLES, &distance));
    TRUE(distance == -1.0f);
    REFUSED(PALP_NULL, palp_chain_set_options(world, arm, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_chain_set_options(world, arm, CROOKED(palp_chain_options *, &options)));
    REFUSED(PALP_STALE_CHAIN, palp_chain_set_options(world, gone_chain, &options));
    options.attraction_s = NAN;
    REFUSED(PALP_BAD_OPTIONS, palp_chain_set_options(world, arm, &options));
    for (i = 0; i < ANGLES; i++) {
        wild[i] = i % 2 ? 3e38f : -3e38f;
    }
    FINE(palp_chain_set_angles(world, arm, wild, ANGLES));
    FINE(palp_chain_set_tip(world, arm, &good, wild, ANGLES, &distance));
    TRUE(distance >= 0.0f && distance < 1e3f);
}

static void reading_chains(void) {
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    const float *angles = NULL;
    const palp_pose *poses = NULL;
    palp_chain_state state = PALP_CHAIN_STATE_INIT;
    uint32_t count = 0, i;
#define READING(call, column)                                                                      \
    REFUSED(PALP_NULL, call(NULL, arm, &column, &count));                                          \
    REFUSED(PALP_NULL, call(world, arm, NULL, &count));                                            \
    REFUSED(PALP_MISALIGNED, call(world, arm, &column, CROOKED(uint32_t *, &count)));              \
    REFUSED(PALP_STALE_CHAIN, call(world, null_chain, &column, &count));                           \
    REFUSED(PALP_STALE_CHAIN, call(world, gone_chain, &column, &count));                           \
    TRUE(column == NULL && count == 0);                                                            \
    GIVES(PALP_OK, call(world, arm, &column, NULL));                                               \
    GIVES(PALP_OK, call(world, arm, &column, &count));                                             \
    TRUE(column != NULL && count == ANGLES);                                                       \
    count = 0
    READING(palp_chain_angles, angles);
    angles = NULL;
    READING(palp_chain_target_angles, angles);
    READING(palp_chain_link_poses, poses);
    REFUSED(PALP_NULL, palp_chain_report(world, arm, NULL));
    REFUSED(PALP_NULL, palp_chain_report(NULL, arm, &state));
    REFUSED(PALP_STALE_CHAIN, palp_chain_report(world, gone_chain, &state));
    state.struct_size--;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_chain_report(world, arm, &state));
    state.struct_size = sizeof state;
    GIVES(PALP_OK, palp_chain_report(world, arm, &state));
    FINE(palp_frame_step(world, &input, NULL));
    FINE(palp_chain_angles(world, arm, &angles, NULL));
    for (i = 0; i < ANGLES; i++) {
        TRUE(angles[i] > -6.3f && angles[i] < 6.3f);
    }
}

/* Structs as an older header declares them. */
static void older_structs(void) {
    palp_capacities room = small_room();
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_frame_report report = PALP_FRAME_REPORT_INIT;
    palp_driven_state state = PALP_DRIVEN_STATE_INIT;
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_body_id id;
    const size_t with_chains = palp_memory_bytes(&room);
    room.struct_size = 28;
    TRUE(palp_memory_bytes(&room) < with_chains);
    room.struct_size = 32;
    TRUE(palp_memory_bytes(&room) == 0);
    input.struct_size = 16;
    FINE(palp_frame_step(world, &input, NULL));
    body.struct_size = WITHOUT_PUSH;
    body.kind = PALP_KIND_DRIVEN;
    body.coupling.push = 77;
    FINE(palp_body_add(world, &body, &id));
    FINE(palp_body_remove(world, id));
    state.struct_size = offsetof(palp_driven_state, reaction_n);
    state.reaction_n.x = 77.0f;
    FINE(palp_driven_report(world, hand, &state));
    TRUE(state.reaction_n.x == 77.0f);
    report.struct_size = offsetof(palp_frame_report, events);
    report.events = 77;
    FINE(palp_frame_step(world, &input, &report));
    TRUE(report.events == 77 && report.frame > 0);
    input.struct_size = 18;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_frame_step(world, &input, NULL));
}

/* A whole header before a state that makes no sense: the library may fail, but must come back. */
static void failing_inside(void) {
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    char *copy = (char *)aligned(malloc(memory_bytes + PALP_BLOCK_ALIGNMENT));
    palp_world *broken = NULL;
    memcpy(copy, memory, memory_bytes);
    FINE(palp_world_attach(copy, memory_bytes, &broken));
    memset(copy + 64, 0xff, memory_bytes - 64);
    GIVES(PALP_PANICKED, palp_frame_step(broken, &input, NULL));
}

int main(void) {
    make_world();
    creating();
    attaching();
    bodies();
    placing();
    pieces();
    full_vertices();
    materials();
    queries();
    frames();
    states();
    hands();
    cones();
    adding_chains();
    full_chains();
    pieces_of_chains();
    driving_chains();
    reading_chains();
    older_structs();
    failing_inside();
    printf("%d refusals as they should be\n", refusals);
    return 0;
}
