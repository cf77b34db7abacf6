// A straight arm of two hinges is raised into a wall, from C++11. Prints the hash of the final state.
#include <palpable.h>

#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace {

constexpr float wall_z = -0.55f;

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

  private:
    std::vector<unsigned char> memory_;
    palp_world *world_ = nullptr;
};

palp_body_id add_wall(palp_world *world) {
    palp_body_def def = PALP_BODY_DEF_INIT;
    palp_piece_def box = PALP_PIECE_DEF_INIT;
    palp_body_id body;
    palp_piece_id piece;
    def.pose.position.z = wall_z - 0.1f;
    box.shape = PALP_SHAPE_BOX;
    box.a = palp_vec3{2.0f, 2.0f, 0.1f};
    check(palp_body_add(world, &def, &body));
    check(palp_piece_add(world, body, &box, &piece));
    return body;
}

palp_chain_id add_arm(palp_world *world, palp_body_id body) {
    std::array<palp_joint, 2> joints = {{PALP_JOINT_INIT, PALP_JOINT_INIT}};
    for (palp_joint &joint : joints) {
        joint.low_rad = -2.0f;
        joint.high_rad = 2.0f;
    }
    joints[1].rest_pose.position.z = -0.35f;
    palp_chain_def def = PALP_CHAIN_DEF_INIT;
    def.joints = joints.data();
    def.joint_count = joints.size();
    def.options.attraction_s = 0.03f;
    palp_chain_id chain;
    check(palp_chain_add(world, body, &def, &chain));
    palp_piece_def capsule = PALP_PIECE_DEF_INIT;
    capsule.shape = PALP_SHAPE_SEGMENT;
    capsule.b.z = -0.35f;
    capsule.radius_m = 0.04f;
    for (std::uint32_t link = 0; link < 2; link++) {
        palp_piece_id piece;
        check(palp_chain_add_piece(world, chain, link, &capsule, &piece));
    }
    const std::array<float, 2> down = {{-1.5f, 0.0f}};
    check(palp_chain_place(world, chain, down.data(), down.size()));
    return chain;
}

void run() {
    World owner(PALP_CAPACITIES_ROOM);
    palp_world *world = owner.get();
    const palp_body_id wall = add_wall(world);
    palp_body_def def = PALP_BODY_DEF_INIT;
    def.kind = PALP_KIND_DRIVEN;
    palp_body_id body;
    check(palp_body_add(world, &def, &body));
    const palp_chain_id arm = add_arm(world, body);
    const palp_frame_input input = PALP_FRAME_INPUT_INIT;
    const palp_pose root = PALP_POSE_IDENTITY;
    int bent = 0;
    for (int frame = 0; frame < 120; frame++) {
        const std::array<float, 2> seen = {{0.0125f * static_cast<float>(frame) - 1.5f, 0.25f}};
        palp_chain_state state = PALP_CHAIN_STATE_INIT;
        palp_penetration_result found = PALP_PENETRATION_RESULT_INIT;
        check(palp_body_set_target(world, body, &root));
        check(palp_chain_set_angles(world, arm, seen.data(), seen.size()));
        check(palp_frame_step(world, &input, nullptr));
        check(palp_chain_report(world, arm, &state));
        check(palp_penetration(world, body, wall, &found));
        bent += (state.flags & PALP_CHAIN_BENT) != 0;
        if (found.depth_m > 1e-4f) {
            throw std::runtime_error("the arm is in the wall");
        }
    }
    if (bent < 10) {
        throw std::runtime_error("the arm did not bend");
    }
    std::uint64_t hash = 0;
    check(palp_state_hash(world, &hash));
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
