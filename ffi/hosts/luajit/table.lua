-- The scene of hosts/c/table.c through LuaJIT's FFI: the same inputs, so the same hash.
-- luajit table.lua SHARED_LIBRARY PREPROCESSED_HEADER HEADER
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

local FRAMES, TABLE_TOP, FINGERS = 600, 0.72, 5
local PIECES = 1 + 2 * FINGERS
local JOINTS = { [0] = 0, 3, 4, 7, 9, 12, 14, 17, 19, 22, 24 }
local KEYS = {
    { 0, -0.25, 0.85, 0.05 }, { 60, -0.20, 0.87, 0.0 }, { 120, -0.25, 0.85, 0.05 },
    { 180, -0.25, 0.70, 0.05 }, { 300, -0.05, 0.70, 0.05 }, { 360, -0.05, 0.79, 0.05 },
    { 420, -0.05, 0.77, 0.0 }, { 600, 0.30, 0.77, 0.0 },
}

-- Lua's numbers are doubles: one operation on floats, rounded at once, is that operation in float.
local cell = ffi.new("float[1]")
local function f(x)
    cell[0] = x
    return cell[0]
end
local function add(a, b) return f(f(a) + f(b)) end
local function sub(a, b) return f(f(a) - f(b)) end
local function mul(a, b) return f(f(a) * f(b)) end
local function div(a, b) return f(f(a) / f(b)) end

local function ok(status)
    if status < 0 then
        error(ffi.string(C.palp_status_text(status)), 2)
    end
    return status
end

local function between(from, to, share)
    return add(from, mul(sub(to, from), share))
end

local function wrist_at(frame)
    local k = 1
    while frame > KEYS[k + 1][1] do
        k = k + 1
    end
    local a, b = KEYS[k], KEYS[k + 1]
    local share = div(frame - a[1], b[1] - a[1])
    return between(a[2], b[2], share), between(a[3], b[3], share), between(a[4], b[4], share)
end

local function bend_at(frame)
    local step = frame % 60
    return mul(0.3, div(step < 30 and step or 60 - step, 30))
end

local function set_pose(pose, x, y, z, half_tangent)
    pose.orientation.x, pose.orientation.y, pose.orientation.z = sub(0, half_tangent), 0, 0
    pose.orientation.w = 1
    pose.position.x, pose.position.y, pose.position.z = x, y, z
end

ffi.cdef [[
typedef struct joint_location { uint64_t flags; palp_pose pose; float radius; } joint_location;
]]

local function see_hand(frame, joints)
    local x, y, z = wrist_at(frame)
    local bend = bend_at(frame)
    for j = 0, P.HAND_JOINTS - 1 do
        joints[j].flags = 3
        set_pose(joints[j].pose, x, y, z, 0)
        joints[j].radius = 0.008
    end
    set_pose(joints[0].pose, x, y, sub(z, 0.05), 0)
    for finger = 0, FINGERS - 1 do
        local across = add(x, sub(mul(0.02, finger), 0.04))
        set_pose(joints[JOINTS[1 + 2 * finger]].pose, across, y, sub(z, 0.1), 0)
        set_pose(joints[JOINTS[2 + 2 * finger]].pose, across, sub(y, mul(0.02, bend)),
            sub(z, 0.138), bend)
    end
    if frame >= 200 and frame < 210 then
        joints[9].flags = 0
        joints[14].pose.orientation.x = 0
        joints[14].pose.orientation.w = 0
    end
end

local function add_body(world, kind, x, y, z)
    local def, body = ffi.new("palp_body_def"), ffi.new("palp_body_id")
    def.struct_size = ffi.sizeof(def)
    def.kind = kind
    set_pose(def.pose, x, y, z, 0)
    local spring = def.coupling
    spring.mass_kg, spring.stiffness_n_per_m, spring.damping_n_s_per_m = 0.4, 1000, 40
    spring.divergence_m, spring.snap, spring.grace_s = 0.3, P.SNAP_NEVER, 0.1
    ok(C.palp_body_add(world, def, body))
    return body
end

local function piece_def(shape)
    local def = ffi.new("palp_piece_def")
    def.struct_size = ffi.sizeof(def)
    def.shape = shape
    def.density_kg_m3 = 700
    set_pose(def.local_pose, 0, 0, 0, 0)
    return def
end

local function add_piece(world, body, def)
    local piece = ffi.new("palp_piece_id")
    ok(C.palp_piece_add(world, body, def, piece))
    return piece
end

local function add_fixed_box(world, x, y, z, half)
    local def = piece_def(P.SHAPE_BOX)
    def.a = half
    add_piece(world, add_body(world, P.KIND_FIXED, x, y, z), def)
end

local function add_ball(world)
    local ball = add_body(world, P.KIND_DYNAMIC, 0.15, 0.761, -0.08)
    local def = piece_def(P.SHAPE_POINT)
    def.radius_m = 0.04
    add_piece(world, ball, def)
    return ball
end

local function add_hand(world)
    local hand = add_body(world, P.KIND_DRIVEN, KEYS[1][2], KEYS[1][3], KEYS[1][4])
    local palm, finger = piece_def(P.SHAPE_BOX), piece_def(P.SHAPE_SEGMENT)
    palm.material, finger.material = P.MATERIAL_HUMAN, P.MATERIAL_HUMAN
    palm.a.x, palm.a.y, palm.a.z, palm.radius_m = 0.04, 0.008, 0.045, 0.005
    palm.local_pose.position.z = -0.05
    add_piece(world, hand, palm)
    finger.a.x, finger.a.y, finger.a.z = 0, 0, 0
    finger.b.z, finger.radius_m = -0.035, 0.008
    for p = 1, PIECES - 1 do
        local across = sub(mul(0.02, math.floor((p - 1) / 2)), 0.04)
        set_pose(finger.local_pose, across, 0, p % 2 == 1 and -0.1 or -0.138, 0)
        add_piece(world, hand, finger)
    end
    return hand
end

local room = ffi.new("palp_capacities")
room.struct_size = ffi.sizeof(room)
ok(C.palp_capacities_room(room))
local bytes = tonumber(C.palp_memory_bytes(room))
local memory = ffi.new("uint8_t[?]", bytes + P.BLOCK_ALIGNMENT)
local past = tonumber(ffi.cast("uintptr_t", memory) % P.BLOCK_ALIGNMENT)
local handle = ffi.new("palp_world *[1]")
ok(C.palp_world_create_abi2(memory + (P.BLOCK_ALIGNMENT - past), bytes, room, handle))
local world = handle[0]

add_fixed_box(world, 0, 0.70, 0, { 0.6, 0.02, 0.4 })
add_fixed_box(world, 0, 0.75, 0.04, { 0.02, 0.03, 0.02 })
local ball = add_ball(world)
local hand = add_hand(world)

local joints = ffi.new("joint_location[?]", P.HAND_JOINTS)
local piece_joints = ffi.new("uint32_t[?]", PIECES)
for p = 0, PIECES - 1 do
    piece_joints[p] = JOINTS[p]
end
local input, report = ffi.new("palp_frame_input"), ffi.new("palp_frame_report")
input.struct_size, report.struct_size = ffi.sizeof(input), ffi.sizeof(report)
input.dt_s, input.advance_units, input.impulse_units = 1 / 60, 0xffffffff, 0xffffffff
input.reach_steps = 0xffffffff

local pose = ffi.new("palp_pose")
for frame = 0, FRAMES - 1 do
    see_hand(frame, joints)
    ok(C.palp_hand_set_joints(world, hand, joints, ffi.sizeof("joint_location"), nil, piece_joints,
        PIECES, 0.5, nil))
    ok(C.palp_frame_step(world, input, report))
    ok(C.palp_body_pose(world, ball, pose))
    assert(pose.position.y - 0.04 > TABLE_TOP - 1e-3, "the ball is in the table")
end

local hash = ffi.new("uint64_t[1]")
ok(C.palp_state_hash(world, hash))
print("hash " .. bit.tohex(tonumber(bit.rshift(hash[0], 32))) .. bit.tohex(tonumber(bit.band(hash[0], 0xffffffffULL))))
