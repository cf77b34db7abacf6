-- The scene of hosts/cpp/elbow.cpp through LuaJIT's FFI: the same inputs, so the same hash.
-- luajit elbow.lua SHARED_LIBRARY PREPROCESSED_HEADER HEADER
local ffi = require("ffi")

local library, preprocessed, header = arg[1], arg[2], arg[3]

local function read(path)
    local file = assert(io.open(path))
    local text = file:read("*a")
    file:close()
    return text
end

ffi.cdef(read(preprocessed))
local C = ffi.load(library)

-- Numbers of the header that the preprocessor took away.
local P = {}
for name, value in read(header):gmatch("#define PALP_([%w_]+) (%-?%d+)\n") do
    P[name] = tonumber(value)
end

local function ok(status)
    if status < 0 then
        error(ffi.string(C.palp_status_text(status)), 2)
    end
    return status
end

-- Structs that say their own size, with rotations of unit length.
local function sized(name)
    local struct = ffi.new(name)
    struct.struct_size = ffi.sizeof(struct)
    return struct
end

local function add_body(world, kind, z)
    local def, body = sized("palp_body_def"), ffi.new("palp_body_id")
    def.kind = kind
    def.pose.orientation.w = 1
    def.pose.position.z = z
    local spring = def.coupling
    spring.mass_kg, spring.stiffness_n_per_m, spring.damping_n_s_per_m = 0.4, 1000, 40
    spring.divergence_m, spring.snap, spring.grace_s = 0.3, P.SNAP_NEVER, 0.1
    ok(C.palp_body_add(world, def, body))
    return body
end

local function piece_def(shape)
    local def = sized("palp_piece_def")
    def.shape = shape
    def.density_kg_m3 = 700
    def.local_pose.orientation.w = 1
    return def
end

local function add_arm(world, body)
    local joints = ffi.new("palp_joint[2]")
    for j = 0, 1 do
        joints[j].struct_size = ffi.sizeof("palp_joint")
        joints[j].kind = P.JOINT_HINGE
        joints[j].rest_pose.orientation.w = 1
        joints[j].axis.x = 1
        joints[j].low_rad, joints[j].high_rad = -2, 2
    end
    joints[1].rest_pose.position.z = -0.35
    local def, chain = sized("palp_chain_def"), ffi.new("palp_chain_id")
    def.joints, def.joint_count = joints, 2
    def.options.flags, def.options.attraction_s = P.OPTION_MOVES_ROOT, 0.03
    ok(C.palp_chain_add(world, body, def, chain))
    local capsule, piece = piece_def(P.SHAPE_SEGMENT), ffi.new("palp_piece_id")
    capsule.b.z, capsule.radius_m = -0.35, 0.04
    for link = 0, 1 do
        ok(C.palp_chain_add_piece(world, chain, link, capsule, piece))
    end
    return chain
end

local room = sized("palp_capacities")
ok(C.palp_capacities_room(room))
local bytes = tonumber(C.palp_memory_bytes(room))
local memory = ffi.new("uint8_t[?]", bytes + P.BLOCK_ALIGNMENT)
local past = tonumber(ffi.cast("uintptr_t", memory) % P.BLOCK_ALIGNMENT)
local handle = ffi.new("palp_world *[1]")
ok(C.palp_world_create_abi2(memory + (P.BLOCK_ALIGNMENT - past), bytes, room, handle))
local world = handle[0]

-- Lua's numbers are doubles: each sum and product is rounded at once, as in float.
local cell = ffi.new("float[1]")
local function f(x)
    cell[0] = x
    return cell[0]
end

local wall = add_body(world, P.KIND_FIXED, f(f(-0.55) - f(0.1)))
local box = piece_def(P.SHAPE_BOX)
box.a = { 2, 2, 0.1 }
ok(C.palp_piece_add(world, wall, box, ffi.new("palp_piece_id")))
local body = add_body(world, P.KIND_DRIVEN, 0)
local arm = add_arm(world, body)

local angles = ffi.new("float[2]", -1.5, 0)
ok(C.palp_chain_place(world, arm, angles, 2))

local input, root = sized("palp_frame_input"), ffi.new("palp_pose")
input.dt_s, input.advance_units, input.impulse_units = 1 / 60, 0xffffffff, 0xffffffff
input.reach_steps = 0xffffffff
root.orientation.w = 1
local found = sized("palp_penetration_result")
for frame = 0, 119 do
    angles[0], angles[1] = f(f(f(0.0125) * frame) - 1.5), 0.25
    ok(C.palp_body_set_target(world, body, root))
    ok(C.palp_chain_set_angles(world, arm, angles, 2))
    ok(C.palp_frame_step(world, input, nil))
    ok(C.palp_penetration(world, body, wall, found))
    assert(found.depth_m < 1e-4, "the arm is in the wall")
end

local hash = ffi.new("uint64_t[1]")
ok(C.palp_state_hash(world, hash))
print("hash " .. bit.tohex(tonumber(bit.rshift(hash[0], 32))) .. bit.tohex(tonumber(bit.band(hash[0], 0xffffffffULL))))
