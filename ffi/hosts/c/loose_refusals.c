/*
 * What a host can get wrong with loose bodies gets the status that the header says, and leaves the world
 * as it was, or takes the good entries among many and names the first bad one. C99 and C++11. Exits with
 * 1 at the first thing that is otherwise.
 */
#include "refusals.h"

#define HOSTED 3

static palp_body_id fixed, loose, hand, gone, hosted[HOSTED];
static const palp_vec3 none = {0.0f, 0.0f, 0.0f};

static palp_body_id add_ball(uint32_t kind, float height) {
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_body_id id;
    palp_piece_id piece_id;
    body.kind = kind;
    body.pose.position.y = height;
    piece.shape = PALP_SHAPE_POINT;
    piece.radius_m = 0.1f;
    FINE(palp_body_add(world, &body, &id));
    FINE(palp_piece_add(world, id, &piece, &piece_id));
    return id;
}

static void make_world(void) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    int i;
    memory_bytes = palp_memory_bytes(&room);
    memory = (char *)aligned(malloc(memory_bytes + PALP_BLOCK_ALIGNMENT));
    FINE(palp_world_create(memory, memory_bytes, &room, &world));
    fixed = add_ball(PALP_KIND_FIXED, 0.0f);
    loose = add_ball(PALP_KIND_DYNAMIC, 10.0f);
    hand = add_ball(PALP_KIND_DRIVEN, 20.0f);
    gone = add_ball(PALP_KIND_HOSTED, 30.0f);
    FINE(palp_body_remove(world, gone));
    for (i = 0; i < HOSTED; i++) {
        hosted[i] = add_ball(PALP_KIND_HOSTED, 30.0f + (float)i);
    }
}

static void forces(void) {
    const palp_vec3 much = {0.0f, 6e8f, 0.0f}, wild = {0.0f, NAN, 0.0f}, far = {2e3f, 0.0f, 0.0f};
    const palp_vec3 endless = {0.0f, 0.0f, -INFINITY};
    REFUSED(PALP_NULL, palp_body_apply_force(NULL, loose, &none, &none));
    REFUSED(PALP_NULL, palp_body_apply_force(world, loose, NULL, &none));
    REFUSED(PALP_NULL, palp_body_apply_force(world, loose, &none, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_body_apply_force(world, loose, CROOKED(const palp_vec3 *, &none), &none));
    REFUSED(PALP_STALE_BODY, palp_body_apply_force(world, null_body, &none, &none));
    REFUSED(PALP_STALE_BODY, palp_body_apply_force(world, gone, &none, &none));
    REFUSED(PALP_WRONG_KIND, palp_body_apply_force(world, hand, &none, &none));
    REFUSED(PALP_WRONG_KIND, palp_body_apply_force(world, fixed, &none, &none));
    REFUSED(PALP_WRONG_KIND, palp_body_apply_force(world, hosted[0], &none, &none));
    REFUSED(PALP_BAD_FORCE, palp_body_apply_force(world, loose, &wild, &none));
    REFUSED(PALP_BAD_FORCE, palp_body_apply_force(world, loose, &none, &endless));
    FINE(palp_body_apply_force(world, loose, &much, &none));
    REFUSED(PALP_BAD_FORCE, palp_body_apply_force(world, loose, &much, &none));
    REFUSED(PALP_NULL, palp_body_apply_impulse(NULL, loose, &none, &none));
    REFUSED(PALP_NULL, palp_body_apply_impulse(world, loose, NULL, &none));
    REFUSED(PALP_NULL, palp_body_apply_impulse(world, loose, &none, NULL));
    REFUSED(PALP_MISALIGNED,
            palp_body_apply_impulse(world, loose, &none, CROOKED(const palp_vec3 *, &none)));
    REFUSED(PALP_STALE_BODY, palp_body_apply_impulse(world, gone, &none, &none));
    REFUSED(PALP_WRONG_KIND, palp_body_apply_impulse(world, hosted[0], &none, &none));
    REFUSED(PALP_BAD_FORCE, palp_body_apply_impulse(world, loose, &wild, &none));
    REFUSED(PALP_BAD_POSE, palp_body_apply_impulse(world, loose, &none, &wild));
    REFUSED(PALP_BAD_POSE, palp_body_apply_impulse(world, loose, &none, &far));
}

static void sleep_of_bodies(void) {
    uint32_t asleep = 9;
    REFUSED(PALP_NULL, palp_body_is_asleep(NULL, loose, &asleep));
    REFUSED(PALP_NULL, palp_body_is_asleep(world, loose, NULL));
    REFUSED(PALP_MISALIGNED, palp_body_is_asleep(world, loose, CROOKED(uint32_t *, &asleep)));
    REFUSED(PALP_STALE_BODY, palp_body_is_asleep(world, gone, &asleep));
    REFUSED(PALP_WRONG_KIND, palp_body_is_asleep(world, hand, &asleep));
    REFUSED(PALP_WRONG_KIND, palp_body_is_asleep(world, hosted[0], &asleep));
    TRUE(asleep == 9);
    FINE(palp_body_is_asleep(world, loose, &asleep));
    TRUE(asleep == 0);
}

/* A host's own struct, with what the library wants in its middle. */
typedef struct thing {
    char name[8];
    palp_hosted_input told;
    palp_hosted_state felt;
    double price;
} thing;

static thing things[HOSTED];
static palp_refusal refusal;

static void good_things(void) {
    const palp_hosted_input told = PALP_HOSTED_INPUT_INIT;
    const palp_hosted_state felt = PALP_HOSTED_STATE_INIT;
    int i;
    memset(things, 0, sizeof things);
    for (i = 0; i < HOSTED; i++) {
        things[i].told = told;
        things[i].told.body = hosted[i];
        things[i].told.pose.position.y = 30.0f + (float)i;
        things[i].told.mass_kg = 1.0f;
        things[i].told.moments_kg_m2.x = things[i].told.moments_kg_m2.y = 0.1f;
        things[i].told.moments_kg_m2.z = 0.1f;
        things[i].felt = felt;
        things[i].felt.push_n_s = 77.0f;
    }
}

static palp_status set(void) {
    refusal.index = 99;
    refusal.status = 99;
    return palp_hosted_set(world, &things[0].told, HOSTED, sizeof(thing), &refusal);
}

/* The calls as a whole. */
static void hosted_calls(void) {
    const palp_hosted_input *inputs = &things[0].told;
    good_things();
    REFUSED(PALP_NULL, palp_hosted_set(NULL, inputs, 1, sizeof(thing), NULL));
    REFUSED(PALP_NULL, palp_hosted_set(world, NULL, 1, sizeof(thing), NULL));
    REFUSED(PALP_MISALIGNED, palp_hosted_set(world, CROOKED(const palp_hosted_input *, inputs), 1,
                                             sizeof(thing), NULL));
    REFUSED(PALP_MISALIGNED, palp_hosted_set(world, inputs, 1, sizeof(thing),
                                             CROOKED(palp_refusal *, &refusal)));
    REFUSED(PALP_BAD_STRIDE, palp_hosted_set(world, inputs, 1, 0, NULL));
    REFUSED(PALP_BAD_STRIDE, palp_hosted_set(world, inputs, HOSTED, 0, NULL));
    REFUSED(PALP_BAD_STRIDE, palp_hosted_set(world, inputs, 1, sizeof *inputs - 4, NULL));
    REFUSED(PALP_BAD_STRIDE, palp_hosted_set(world, inputs, 1, sizeof *inputs + 2, NULL));
    REFUSED(PALP_INSIDE_WORLD, palp_hosted_set(world, (const palp_hosted_input *)(void *)memory, 1,
                                               sizeof *inputs, NULL));
    REFUSED(PALP_OK, palp_hosted_set(world, NULL, 0, 0, &refusal));
    TRUE(refusal.index == 0 && refusal.status == PALP_OK);
    FINE(set());
    TRUE(refusal.index == HOSTED && refusal.status == PALP_OK);
}

/* Every entry by itself: a bad one stays as it was, its neighbours move. */
static void hosted_entries(void) {
    palp_pose pose;
    float height = 100.0f;
#define BAD_ENTRY(why, change)                                                                     \
    good_things();                                                                                 \
    things[1].told.change;                                                                         \
    things[2].told.pose.position.y = (height += 1.0f);                                             \
    GIVES(PALP_ENTRIES_REFUSED, set());                                                            \
    TRUE(refusal.index == 1 && refusal.status == why);                                             \
    FINE(palp_body_pose(world, hosted[1], &pose));                                                 \
    TRUE(pose.position.y == 31.0f);                                                                \
    FINE(palp_body_pose(world, hosted[2], &pose));                                                 \
    TRUE(pose.position.y == height)
    BAD_ENTRY(PALP_BAD_STRUCT_SIZE, struct_size = 0);
    BAD_ENTRY(PALP_BAD_STRUCT_SIZE, struct_size--);
    BAD_ENTRY(PALP_BAD_STRUCT_SIZE, struct_size = UINT32_MAX);
    BAD_ENTRY(PALP_BAD_STRUCT_SIZE, struct_size = sizeof(thing) + 4);
    BAD_ENTRY(PALP_STALE_BODY, body = null_body);
    BAD_ENTRY(PALP_STALE_BODY, body = gone);
    BAD_ENTRY(PALP_WRONG_KIND, body = loose);
    BAD_ENTRY(PALP_WRONG_KIND, body = hand);
    BAD_ENTRY(PALP_BAD_POSE, pose.position.x = NAN);
    BAD_ENTRY(PALP_BAD_POSE, pose.position.y = 2e3f);
    BAD_ENTRY(PALP_BAD_POSE, pose.orientation.w = 0.0f);
    BAD_ENTRY(PALP_BAD_VELOCITY, velocity_m_s.z = NAN);
    BAD_ENTRY(PALP_BAD_VELOCITY, velocity_m_s.z = 2e3f);
    BAD_ENTRY(PALP_BAD_VELOCITY, spin_rad_s.x = -INFINITY);
    BAD_ENTRY(PALP_BAD_MASS, mass_kg = NAN);
    BAD_ENTRY(PALP_BAD_MASS, mass_kg = -1.0f);
    BAD_ENTRY(PALP_BAD_MASS, mass_kg = 1e-12f);
    BAD_ENTRY(PALP_BAD_MASS, moments_kg_m2.y = 0.0f);
    BAD_ENTRY(PALP_BAD_MASS, moments_kg_m2.y = INFINITY);
    BAD_ENTRY(PALP_BAD_MASS, centre.x = NAN);
    BAD_ENTRY(PALP_BAD_MASS, axes.w = 0.0f);
    good_things();
    things[0].told.mass_kg = 0.0f;
    things[0].told.moments_kg_m2 = none;
    FINE(set());
    things[1].told.body = gone;
    things[2].told.mass_kg = NAN;
    GIVES(PALP_ENTRIES_REFUSED, set());
    TRUE(refusal.index == 1 && refusal.status == PALP_STALE_BODY);
    GIVES(PALP_ENTRIES_REFUSED,
          palp_hosted_set(world, &things[0].told, HOSTED, sizeof(thing), NULL));
}

static palp_status read_all(const palp_body_id *bodies, uint32_t body_stride, uint32_t state_stride) {
    refusal.index = 99;
    refusal.status = 99;
    return palp_hosted_impulses(world, bodies, body_stride, &things[0].felt, state_stride, HOSTED,
                                &refusal);
}

static void hosted_reads(void) {
    palp_hosted_state *states = &things[0].felt;
    palp_body_id *bodies = &things[0].told.body;
    good_things();
    REFUSED(PALP_NULL, palp_hosted_impulse(NULL, hosted[0], states));
    REFUSED(PALP_NULL, palp_hosted_impulse(world, hosted[0], NULL));
    REFUSED(PALP_MISALIGNED,
            palp_hosted_impulse(world, hosted[0], CROOKED(palp_hosted_state *, states)));
    REFUSED(PALP_STALE_BODY, palp_hosted_impulse(world, gone, states));
    REFUSED(PALP_STALE_BODY, palp_hosted_impulse(world, null_body, states));
    REFUSED(PALP_WRONG_KIND, palp_hosted_impulse(world, loose, states));
    states->struct_size--;
    REFUSED(PALP_BAD_STRUCT_SIZE, palp_hosted_impulse(world, hosted[0], states));
    states->struct_size++;
    TRUE(states->push_n_s == 77.0f);
    REFUSED(PALP_OK, palp_hosted_impulse(world, hosted[0], states));
    TRUE(states->push_n_s == 0.0f && states->contacts == 0);
    REFUSED(PALP_NULL, palp_hosted_impulses(NULL, bodies, 8, states, 48, 1, NULL));
    REFUSED(PALP_NULL, palp_hosted_impulses(world, NULL, 8, states, 48, 1, NULL));
    REFUSED(PALP_NULL, palp_hosted_impulses(world, bodies, 8, NULL, 48, 1, NULL));
    REFUSED(PALP_BAD_STRIDE, read_all(bodies, 0, sizeof(thing)));
    REFUSED(PALP_BAD_STRIDE, read_all(bodies, 6, sizeof(thing)));
    REFUSED(PALP_BAD_STRIDE, read_all(bodies, sizeof(thing), 0));
    REFUSED(PALP_BAD_STRIDE, read_all(bodies, sizeof(thing), sizeof *states - 4));
    REFUSED(PALP_INSIDE_WORLD,
            palp_hosted_impulses(world, bodies, sizeof(thing), (palp_hosted_state *)(void *)memory,
                                 sizeof *states, 1, NULL));
    REFUSED(PALP_OK, read_all(hosted, sizeof hosted[0], sizeof(thing)));
    TRUE(refusal.index == HOSTED && things[2].felt.push_n_s == 0.0f);
    good_things();
    things[0].told.body = gone;
    things[1].felt.struct_size = 0;
    REFUSED(PALP_ENTRIES_REFUSED, read_all(bodies, sizeof(thing), sizeof(thing)));
    TRUE(refusal.index == 0 && refusal.status == PALP_STALE_BODY);
    TRUE(things[0].felt.push_n_s == 77.0f && things[1].felt.push_n_s == 77.0f);
    TRUE(things[2].felt.push_n_s == 0.0f);
}

static void events(void) {
    const palp_contact_event *column = NULL;
    uint32_t count = 99;
    REFUSED(PALP_NULL, palp_contact_events(NULL, &column, &count));
    REFUSED(PALP_NULL, palp_contact_events(world, NULL, &count));
    REFUSED(PALP_NULL, palp_contact_events(world, &column, NULL));
    REFUSED(PALP_MISALIGNED, palp_contact_events(world, &column, CROOKED(uint32_t *, &count)));
    TRUE(column == NULL && count == 99);
    REFUSED(PALP_OK, palp_contact_events(world, &column, &count));
    TRUE(column != NULL && count == 0);
}

int main(void) {
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    make_world();
    forces();
    sleep_of_bodies();
    hosted_calls();
    hosted_entries();
    hosted_reads();
    events();
    FINE(palp_frame_step(world, &input, NULL));
    printf("%d refusals as they should be\n", refusals);
    return 0;
}
