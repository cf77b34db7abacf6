/* The C example of the README, and what stands around it there. */
#include <palpable.h>
#include <stdio.h>
#include <stdlib.h>

int main(void) {
    palp_capacities room = PALP_CAPACITIES_ROOM;
    size_t bytes = palp_memory_bytes(&room);
    char *block = malloc(bytes + 64);
    char *memory = block + 64 - (size_t)block % 64;
    palp_world *world;
    palp_body_def table = PALP_BODY_DEF_INIT, hand = PALP_BODY_DEF_INIT;
    palp_piece_def top = PALP_PIECE_DEF_INIT, palm = PALP_PIECE_DEF_INIT;
    palp_body_id table_id, hand_id;
    palp_piece_id piece_id;
    palp_frame_input frame = PALP_FRAME_INPUT_INIT;
    palp_pose tracked = PALP_POSE_IDENTITY, drawn = PALP_POSE_IDENTITY;
    if (!block) return 1;
    top.shape = palm.shape = PALP_SHAPE_BOX;
    top.a.x = top.a.y = top.a.z = 0.1f;
    palm.a = top.a;
    hand.kind = PALP_KIND_DRIVEN;
    hand.pose.position.y = 0.5f;

    palp_world_create(memory, bytes, &room, &world);      /* memory is yours, 64-byte aligned */
    palp_body_add(world, &table, &table_id);              /* a fixed body ... */
    palp_piece_add(world, table_id, &top, &piece_id);     /* ... made of convex pieces */
    palp_body_add(world, &hand, &hand_id);                /* a body that follows a tracker */
    palp_piece_add(world, hand_id, &palm, &piece_id);
    for (int i = 0; i < 60; i++) {
        palp_body_set_target(world, hand_id, &tracked);   /* what the tracker sees */
        palp_frame_step(world, &frame, NULL);
        palp_body_pose(world, hand_id, &drawn);           /* what you draw */
    }

    printf("tracked %.3f m, drawn %.3f m\n", tracked.position.y, drawn.position.y);
    free(block);
    return drawn.position.y >= 0.2f ? 0 : 1;
}
