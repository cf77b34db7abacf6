// A driven capsule is told to go through a wall, from C++11. Prints the hash of the final state.
#include <palpable.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace {

void check(palp_status status) {
    if (status < 0) {
        throw std::runtime_error(palp_status_text(status));
    }
}

class World {
  public:
    explicit World(const palp_capacities &capacities)
        : memory_(palp_memory_bytes(&capacities) + PALP_BLOCK_ALIGNMENT) {
        const std::size_t past =
            reinterpret_cast<std::uintptr_t>(memory_.data()) % PALP_BLOCK_ALIGNMENT;
        check(palp_world_create(memory_.data() + (PALP_BLOCK_ALIGNMENT - past),
                                memory_.size() - PALP_BLOCK_ALIGNMENT, &capacities, &world_));
    }

    World(const World &) = delete;
    World &operator=(const World &) = delete;

    palp_world *get() const { return world_; }

    palp_body_id add(std::uint32_t kind, float x, const palp_piece_def &piece) {
        palp_body_def def = PALP_BODY_DEF_INIT;
        def.kind = kind;
        def.pose.position.x = x;
        palp_body_id body;
        palp_piece_id id;
        check(palp_body_add(world_, &def, &body));
        check(palp_piece_add(world_, body, &piece, &id));
        return body;
    }

  private:
    std::vector<unsigned char> memory_;
    palp_world *world_ = nullptr;
};

palp_piece_def wall() {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    def.shape = PALP_SHAPE_BOX;
    def.a = palp_vec3{0.01f, 1.0f, 1.0f};
    return def;
}

palp_piece_def capsule() {
    palp_piece_def def = PALP_PIECE_DEF_INIT;
    def.shape = PALP_SHAPE_SEGMENT;
    def.a = palp_vec3{0.0f, 0.0f, 0.05f};
    def.b = palp_vec3{0.0f, 0.0f, -0.05f};
    def.radius_m = 0.02f;
    return def;
}

void run() {
    World world(PALP_CAPACITIES_ROOM);
    world.add(PALP_KIND_FIXED, 0.0f, wall());
    const palp_body_id hand = world.add(PALP_KIND_DRIVEN, -0.5f, capsule());
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    palp_pose target = PALP_POSE_IDENTITY;
    palp_pose drawn = PALP_POSE_IDENTITY;
    for (int frame = 0; frame < 120; frame++) {
        target.position.x = -0.5f + 0.01f * static_cast<float>(frame);
        const palp_pose local = PALP_POSE_IDENTITY;
        check(palp_body_set_target(world.get(), hand, &target));
        check(palp_body_set_piece_targets(world.get(), hand, &local, 1));
        check(palp_frame_step(world.get(), &input, nullptr));
        check(palp_body_pose(world.get(), hand, &drawn));
        if (drawn.position.x > -0.03f + 1e-4f) {
            throw std::runtime_error("the capsule is in the wall");
        }
    }
    std::uint64_t hash = 0;
    check(palp_state_hash(world.get(), &hash));
    std::printf("hash %016" PRIx64 "\n", hash);
}

} // namespace

int main() {
    try {
        run();
    } catch (const std::exception &error) {
        std::printf("%s\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
