/* What a call costs, in nanoseconds of processor time. */
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define CALLS 100000

#define COST(call)                                                                                 \
    do {                                                                                           \
        const clock_t start = clock();                                                             \
        int i;                                                                                     \
        for (i = 0; i < CALLS; i++) {                                                              \
            failed |= (call) < 0;                                                                  \
        }                                                                                          \
        printf("%7.1f ns  %s\n", 1e9 * (double)(clock() - start) / CLOCKS_PER_SEC / CALLS, #call); \
    } while (0)

int main(void) {
    const palp_capacities room = PALP_CAPACITIES_ROOM;
    const size_t bytes = palp_memory_bytes(&room);
    char *memory = (char *)malloc(bytes + PALP_BLOCK_ALIGNMENT);
    palp_body_def body = PALP_BODY_DEF_INIT;
    palp_piece_def piece = PALP_PIECE_DEF_INIT;
    palp_body_id id;
    palp_piece_id piece_id;
    palp_world *world;
    palp_pose pose = PALP_POSE_IDENTITY;
    const palp_pose *poses;
    const palp_contact *contacts;
    uint32_t count;
    uint64_t hash;
    palp_frame_input input = PALP_FRAME_INPUT_INIT;
    const palp_joint joint = PALP_JOINT_INIT;
    palp_chain_def chain = PALP_CHAIN_DEF_INIT;
    palp_chain_id chain_id;
    const float angle = 0.5f;
    const float *angles;
    int failed = memory == NULL;
    failed |= palp_world_create(memory + PALP_BLOCK_ALIGNMENT - (size_t)memory % PALP_BLOCK_ALIGNMENT,
                                bytes, &room, &world);
    body.kind = PALP_KIND_DRIVEN;
    piece.shape = PALP_SHAPE_POINT;
    piece.radius_m = 0.05f;
    failed |= palp_body_add(world, &body, &id);
    failed |= palp_piece_add(world, id, &piece, &piece_id);
    COST(palp_body_pose(world, id, &pose));
    COST(palp_piece_pose(world, piece_id, &pose));
    COST(palp_piece_poses(world, &poses, &count));
    COST(palp_contacts(world, &contacts, &count));
    COST(palp_body_set_target(world, id, &pose));
    COST(palp_frame_step(world, &input, NULL));
    chain.joints = &joint;
    chain.joint_count = 1;
    failed |= palp_chain_add(world, id, &chain, &chain_id);
    COST(palp_chain_set_angles(world, chain_id, &angle, 1));
    COST(palp_chain_angles(world, chain_id, &angles, &count));
    COST(palp_chain_link_poses(world, chain_id, &poses, &count));
    {
        const clock_t start = clock();
        failed |= palp_state_hash(world, &hash);
        printf("%7.1f us  palp_state_hash of %lu bytes\n",
               1e6 * (double)(clock() - start) / CLOCKS_PER_SEC, (unsigned long)bytes);
    }
    free(memory);
    return failed;
}
