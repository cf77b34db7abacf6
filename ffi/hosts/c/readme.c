#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

int main(void) {
    palp_capacities room = PALP_CAPACITIES_ROOM;
    size_t bytes = palp_memory_bytes(&room);
    char *memory = malloc(bytes + 64);
    palp_world *world;
    if (!memory || palp_world_create(memory + 64 - (size_t)memory % 64, bytes, &room, &world)) return 1;

    palp_body_def block = PALP_BODY_DEF_INIT, hand = PALP_BODY_DEF_INIT;
    palp_piece_def cube = PALP_PIECE_DEF_INIT;
    palp_body_id block_id, hand_id;
    palp_piece_id piece_id;
    cube.shape = PALP_SHAPE_BOX;
    cube.a = (palp_vec3){0.1f, 0.1f, 0.1f};
    hand.kind = PALP_KIND_DRIVEN;
    hand.pose.position.y = 0.5f;
    palp_body_add(world, &block, &block_id);
    palp_body_add(world, &hand, &hand_id);
    palp_piece_add(world, block_id, &cube, &piece_id);
    palp_piece_add(world, hand_id, &cube, &piece_id);

    palp_frame_input frame = PALP_FRAME_INPUT_INIT;
    palp_pose tracked = PALP_POSE_IDENTITY, drawn = PALP_POSE_IDENTITY;
    for (int i = 0; i < 60; i++) {
        palp_body_set_target(world, hand_id, &tracked);
        palp_frame_step(world, &frame, NULL);
        palp_body_pose(world, hand_id, &drawn);
    }
    printf("tracked %.3f m, drawn %.3f m\n", tracked.position.y, drawn.position.y);
    free(memory);
    return 0;
}
