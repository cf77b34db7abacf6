/*
 * A small scene is recorded: a hand with tracked joints pushes a box, an arm bends, a body of the host's own
 * engine is told of, things are refused, the world is rolled back once. The log is replayed in the same
 * process and comes to the same; logs that are damaged, cut or of another kind are refused by name. Copies
 * of the block record nothing, and a sink may not call the library with its own world.
 *
 * Writes the log to the file that is named as the argument, if any. Prints how many calls and frames were
 * replayed, and the hash of the final state. Exits with 1 and a line that says what went wrong.
 */
#include <inttypes.h>
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRAMES 60
#define SAVED_AT 20
#define BACK_AT 30
#define STEP_S (1.0f / 90.0f)

/* XrHandJointLocationEXT. */
typedef struct joint_location {
    uint64_t flags;
    palp_pose pose;
    float radius;
} joint_location;

#define TRACKED 0xf

/* A log in memory, and what its sink is to try beside. */
typedef struct log_buffer {
    unsigned char *bytes;
    size_t size, room;
    palp_world *own;
    palp_status called_back;
} log_buffer;

typedef struct scene {
    palp_world *world;
    palp_body_id box, hand, figure, theirs;
    palp_chain_id arm;
} scene;

static void check(int good, const char *what) {
    if (!good) {
        printf("%s\n", what);
        exit(1);
    }
}

static void gives(palp_status got, palp_status wanted, const char *what) {
    if (got != wanted) {
        printf("%s: %s instead of %s\n", what, palp_status_text(got), palp_status_text(wanted));
        exit(1);
    }
}

static void ok(palp_status status, const char *what) {
    gives(status < 0 ? status : PALP_OK, PALP_OK, what);
}

/* Grows as it must; a real host would write to a file. */
static void sink(void *user, const void *bytes, size_t size) {
    log_buffer *log = (log_buffer *)user;
    if (log->size + size > log->room) {
        log->room = 2 * (log->size + size);
        log->bytes = (unsigned char *)realloc(log->bytes, log->room);
        check(log->bytes != NULL, "no memory");
    }
    memcpy(log->bytes + log->size, bytes, size);
    log->size += size;
    if (log->own != NULL) {
        uint64_t hash;
        log->called_back = palp_state_hash(log->own, &hash);
    }
}

/* A block for a world, 64-byte aligned; never given back, the program is short. */
static void *block_of(size_t bytes) {
    char *memory = (char *)malloc(bytes + PALP_BLOCK_ALIGNMENT);
    check(memory != NULL, "no memory");
    return memory + (PALP_BLOCK_ALIGNMENT - (size_t)memory % PALP_BLOCK_ALIGNMENT);
}

static palp_capacities small_room(void) {
    palp_capacities room = PALP_CAPACITIES_ROOM;
    room.bodies = 8;
    room.pieces = 8;
    room.vertices = 64;
    room.pairs = 32;
    room.contacts = 16;
    room.materials = 1;
    room.chains = 1;
    room.joints = 4;
    return room;
}

static uint64_t hash_of(const palp_world *world) {
    uint64_t hash;
    ok(palp_state_hash(world, &hash), "palp_state_hash");
    return hash;
}

static palp_body_id add_body(palp_world *world, uint32_t kind, float x, float y) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_body_id id;
    def.kind = kind;
    def.pose.position.x = x;
    def.pose.position.y = y;
    ok(palp_body_add(world, &def, &id), "palp_body_add");
    return id;
}

static void add_ball(palp_world *world, palp_body_id body, float radius_m) {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_id id;
    def.shape = PALP_SHAPE_POINT;
    def.radius_m = radius_m;
    ok(palp_piece_add(world, body, &def, &id), "palp_piece_add");
}

static void add_box(palp_world *world, palp_body_id body, float x, float y, float z) {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    palp_piece_id id;
    def.shape = PALP_SHAPE_BOX;
    def.a.x = x;
    def.a.y = y;
    def.a.z = z;
    ok(palp_piece_add(world, body, &def, &id), "palp_piece_add");
}

static void add_arm(scene *s) {
    palp_joint elbow = PALP_JOINT_INIT;
    palp_chain_def def = PALP_CHAIN_DEF_INIT;
    palp_piece_def forearm = PALP_PIECE_DEF_INIT;
    palp_chain_id none;
    palp_piece_id id;
    def.joints = &elbow;
    gives(palp_chain_add(s->world, s->figure, &def, &none), PALP_WRONG_COUNT, "a chain of no joints");
    def.joint_count = 1;
    ok(palp_chain_add(s->world, s->figure, &def, &s->arm), "palp_chain_add");
    gives(palp_chain_add(s->world, s->figure, &def, &none), PALP_FULL_CHAINS, "one chain too many");
    forearm.shape = PALP_SHAPE_SEGMENT;
    forearm.b.z = 0.2f;
    forearm.radius_m = 0.03f;
    ok(palp_chain_add_piece(s->world, s->arm, 0, &forearm, &id), "palp_chain_add_piece");
}

static scene make_scene(palp_world *world) {
    scene s;
    const palp_body_id table = add_body(world, PALP_KIND_FIXED, 0.0f, -0.1f);
    s.world = world;
    add_box(world, table, 2.0f, 0.1f, 2.0f);
    s.box = add_body(world, PALP_KIND_DYNAMIC, 0.12f, 0.0503f);
    add_box(world, s.box, 0.05f, 0.05f, 0.05f);
    s.hand = add_body(world, PALP_KIND_DRIVEN, 0.0f, 0.06f);
    add_ball(world, s.hand, 0.02f);
    add_ball(world, s.hand, 0.02f);
    s.figure = add_body(world, PALP_KIND_DRIVEN, -0.6f, 0.5f);
    add_arm(&s);
    s.theirs = add_body(world, PALP_KIND_HOSTED, 0.4f, 0.5f);
    add_ball(world, s.theirs, 0.05f);
    return s;
}

/* A wrist that goes right, and a finger tip before it that is not seen in every fourth frame. */
static void see_hand(const scene *s, int frame) {
    static const uint32_t carried_by[2] = {1, 10};
    joint_location joints[PALP_HAND_JOINTS];
    int joint;
    for (joint = 0; joint < (int)PALP_HAND_JOINTS; joint++) {
        const palp_pose at = PALP_POSE_IDENTITY;
        joints[joint].flags = joint == 10 && frame % 4 == 0 ? 0 : TRACKED;
        joints[joint].pose = at;
        joints[joint].pose.position.x = 0.003f * (float)frame + (joint == 10 ? 0.03f : 0.0f);
        joints[joint].pose.position.y = 0.06f;
        joints[joint].radius = 0.01f;
    }
    ok(palp_hand_set_joints(s->world, s->hand, joints, 0, NULL, carried_by, 2, 0.5f, NULL),
       "palp_hand_set_joints");
    gives(palp_hand_set_joints(s->world, s->hand, joints, 0, NULL, carried_by, 1, 0.5f, NULL),
          PALP_WRONG_COUNT, "joints of one piece");
}

static void tell(const scene *s, int frame) {
    const float angle = 0.02f * (float)frame;
    palp_pose at = PALP_POSE_IDENTITY;
    palp_hosted_input input = PALP_HOSTED_INPUT_INIT;
    see_hand(s, frame);
    at.position.x = -0.6f;
    at.position.y = 0.5f;
    ok(palp_body_set_target(s->world, s->figure, &at), "palp_body_set_target");
    gives(palp_body_set_target(s->world, s->box, &at), PALP_WRONG_KIND, "the target of a box");
    ok(palp_chain_set_angles(s->world, s->arm, &angle, 1), "palp_chain_set_angles");
    input.body = s->theirs;
    input.pose.position.x = 0.4f;
    input.pose.position.y = 0.5f - 0.005f * (float)frame;
    ok(palp_hosted_set(s->world, &input, 1, sizeof input, NULL), "palp_hosted_set");
}

/* Steps, and rolls back once. */
static void run(const scene *s) {
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    size_t bytes;
    void *state;
    int frame;
    input.dt_s = STEP_S;
    ok(palp_state_bytes(s->world, &bytes), "palp_state_bytes");
    state = malloc(bytes);
    check(state != NULL, "no memory");
    for (frame = 0; frame < FRAMES; frame++) {
        tell(s, frame);
        ok(palp_frame_step(s->world, &input, NULL), "palp_frame_step");
        if (frame == SAVED_AT) {
            ok(palp_state_save(s->world, state, bytes, NULL), "palp_state_save");
        }
        if (frame == BACK_AT) {
            ok(palp_state_load(s->world, state, bytes), "palp_state_load");
            gives(palp_state_load(s->world, state, 8), PALP_DAMAGED, "a part of a state");
        }
    }
    free(state);
}

/* A copy of a recorded block, and the block when the recording has ended, hand nothing to the sink. */
static void leave_the_log_alone(const scene *s, const log_buffer *log, size_t bytes) {
    void *copy = block_of(bytes);
    const size_t size = log->size;
    const palp_vec3 gravity = {0.0f, -1.0f, 0.0f};
    palp_world *other = (palp_world *)copy;
    memcpy(copy, s->world, bytes);
    ok(palp_gravity_set(other, &gravity), "palp_gravity_set");
    check(log->size == size, "a copy of the block is recorded");
    ok(palp_recording_stop(other), "palp_recording_stop");
    ok(palp_gravity_set(s->world, &gravity), "palp_gravity_set");
    check(log->size > size, "the end of a copy's recording is the original's");
}

static uint64_t record(log_buffer *log) {
    const palp_capacities room = small_room();
    const size_t bytes = palp_memory_bytes(&room);
    const palp_vec3 gravity = {0.0f, -9.81f, 0.0f};
    palp_world *world;
    uint64_t hash;
    size_t size;
    scene s;
    ok(palp_world_create(block_of(bytes), bytes, &room, &world), "palp_world_create");
    gives(palp_recording_start(world, NULL, log), PALP_NULL, "no sink");
    gives(palp_recording_start(NULL, sink, log), PALP_NULL, "no world");
    ok(palp_recording_start(world, sink, log), "palp_recording_start");
    s = make_scene(world);
    run(&s);
    leave_the_log_alone(&s, log, bytes);
    log->own = world;
    ok(palp_gravity_set(world, &gravity), "palp_gravity_set");
    log->own = NULL;
    gives(log->called_back, PALP_INSIDE_SINK, "a sink that uses its own world");
    hash = hash_of(world);
    size = log->size;
    ok(palp_recording_stop(world), "palp_recording_stop");
    ok(palp_gravity_set(world, &gravity), "palp_gravity_set");
    ok(palp_recording_start(world, sink, log), "palp_recording_start");
    check(log->size > size, "a second recording does not begin");
    log->size = size;
    ok(palp_world_attach(world, bytes, &world), "palp_world_attach");
    ok(palp_gravity_set(world, &gravity), "palp_gravity_set");
    check(log->size == size, "a world that was taken up anew is recorded");
    return hash;
}

/* Opens a log and makes its world. */
static palp_status begin(const log_buffer *log, palp_replay *replay, palp_world **world) {
    palp_capacities room = PALP_CAPACITIES_ROOM;
    size_t bytes;
    palp_status status = palp_replay_open(log->bytes, log->size, replay);
    if (status < 0) {
        return status;
    }
    ok(palp_replay_capacities(replay, &room), "palp_replay_capacities");
    bytes = palp_memory_bytes(&room);
    gives(palp_replay_start(replay, block_of(bytes), bytes - 1, world), PALP_MEMORY_TOO_SMALL,
          "a block that is too small");
    return palp_replay_start(replay, block_of(bytes), bytes, world);
}

/* Replays a log up to the first call that is not as it was; that call, and why. */
static palp_status replay_all(const log_buffer *log, palp_replayed *call, uint64_t *hash) {
    palp_replay replay = PALP_REPLAY_INIT;
    palp_world *world;
    palp_status status = begin(log, &replay, &world);
    if (status < 0) {
        return status;
    }
    do {
        status = palp_replay_next(&replay, world, call);
    } while (status == PALP_OK);
    *hash = hash_of(world);
    if (status == PALP_REPLAY_END) {
        printf("%" PRIu64 " calls, %" PRIu64 " frames: equal, ", replay.calls, replay.frames);
    }
    return status;
}

/* What a log comes to when one of its bytes is another. */
static palp_status damaged_at(log_buffer *log, size_t at) {
    palp_replayed call = PALP_REPLAYED_INIT;
    uint64_t hash;
    palp_status status;
    log->bytes[at] ^= 1;
    status = replay_all(log, &call, &hash);
    log->bytes[at] ^= 1;
    return status;
}

static void refuse(log_buffer *log) {
    log_buffer cut = *log;
    palp_replay replay = PALP_REPLAY_INIT;
    palp_replayed call = PALP_REPLAYED_INIT;
    palp_world *world;
    uint64_t hash;
    gives(damaged_at(log, 0), PALP_NOT_A_LOG, "other first bytes");
    gives(damaged_at(log, 8), PALP_OTHER_LOG_VERSION, "another version");
    gives(damaged_at(log, 12), PALP_OTHER_LAYOUT, "another layout");
    gives(damaged_at(log, 16), PALP_DAMAGED, "damaged capacities");
    gives(damaged_at(log, 1000), PALP_DAMAGED, "a damaged state");
    gives(damaged_at(log, log->size - 10), PALP_DAMAGED, "a damaged call");
    cut.size -= 1;
    gives(replay_all(&cut, &call, &hash), PALP_LOG_CUT_SHORT, "a log without its last byte");
    cut.size = 50;
    gives(replay_all(&cut, &call, &hash), PALP_LOG_CUT_SHORT, "a part of a head");
    gives(palp_replay_open(NULL, 100, &replay), PALP_NULL, "no log");
    gives(palp_replay_open(log->bytes, log->size, NULL), PALP_NULL, "no replay");
    ok(begin(log, &replay, &world), "begin");
    gives(palp_replay_next(NULL, world, &call), PALP_NULL, "no replay");
    gives(palp_replay_next(&replay, NULL, &call), PALP_NULL, "no world");
    replay.struct_size = 4;
    gives(palp_replay_next(&replay, world, &call), PALP_BAD_STRUCT_SIZE, "a wrong size");
}

/* A world that has one body more gives the first body another id. */
static void differ(const log_buffer *log) {
    palp_replay replay = PALP_REPLAY_INIT;
    palp_replayed call = PALP_REPLAYED_INIT;
    palp_world *world;
    ok(begin(log, &replay, &world), "begin");
    add_body(world, PALP_KIND_FIXED, 0.0f, 5.0f);
    gives(palp_replay_next(&replay, world, &call), PALP_REPLAY_DIFFERS, "another world");
    check(strcmp(palp_call_name(call.kind), "add_body") == 0, "the call has another name");
    check(call.call == 1 && call.frame == 1, "the call has another number");
    check((uint32_t)call.recorded_value == 1 && (uint32_t)call.replayed_value == 2,
          "the ids are others");
}

static void write_to(const char *name, const log_buffer *log) {
    FILE *file = fopen(name, "wb");
    check(file != NULL, "the file cannot be opened");
    check(fwrite(log->bytes, 1, log->size, file) == log->size, "the file cannot be written");
    check(fclose(file) == 0, "the file cannot be closed");
}

int main(int count, char **arguments) {
    log_buffer log = {NULL, 0, 0, NULL, PALP_OK};
    palp_replayed call = PALP_REPLAYED_INIT;
    const uint64_t recorded = record(&log);
    uint64_t replayed = 0;
    gives(replay_all(&log, &call, &replayed), PALP_REPLAY_END, "replay_all");
    check(replayed == recorded, "the replay comes to another state");
    check(call.frame == FRAMES + 1, "other frames than were recorded");
    refuse(&log);
    differ(&log);
    if (count > 1) {
        write_to(arguments[1], &log);
    }
    printf("%lu bytes, hash %016" PRIx64 "\n", (unsigned long)log.size, recorded);
    return 0;
}
