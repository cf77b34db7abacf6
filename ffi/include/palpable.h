/*
 * Palpable: a hard-real-time contact kernel. A tracked hand never reaches through the virtual world.
 *
 * Generated from ffi/src by ffi/tests/header.rs. Do not edit.
 *
 * Units are SI: metres, kilograms, seconds, radians, newtons. Axes and layouts are OpenXR's:
 * right-handed, +Y up, -Z forward, quaternions x y z w, a pose is orientation then position.
 *
 * Memory. A world lies in one block of the host's memory, `palp_memory_bytes` long and aligned to
 * PALP_BLOCK_ALIGNMENT, and nowhere else. The library allocates nothing, keeps no pointer that it is
 * given but a sink and its user, and has no global state. The handle is the block's address: there is
 * nothing to destroy, and a copy of the block is a second world. Give a thread that calls the library
 * 512 kB of stack.
 *
 * Threads. A call with `const palp_world *` is safe beside other such calls on the same world. Any
 * other call needs the world for itself. Distinct worlds are independent.
 *
 * Pointers. Null, unless a comment allows it, and pointers that are not aligned to their type are
 * refused; every other pointer must be good for what its type says. Arguments are read, and results
 * written, during the call only. Results are written when the status is not negative. Arrays that the
 * host gives must not lie in the world's block.
 *
 * Skeletons. A chain is a path of joints on a driven body, or on a link of another chain of that body: an
 * arm, a leg, a finger. A joint is a hinge, or a ball of three hinges with a reach cone. Angles count by
 * hinge, three to a ball, in radians; a link is what moves behind a hinge, and its frame is the hinge's.
 * Pieces lie on links as they lie on bodies. Each frame the host sets the body's target, then the chains',
 * a chain behind the one that it hangs on; steps; and draws `palp_chain_link_poses`.
 *
 * Loose bodies. A dynamic body obeys the library's gravity and impulses. A hosted one obeys the host's own
 * engine, which keeps its collisions with everything but hands. Each frame the host tells of its bodies
 * with `palp_hosted_set`, steps, adds what `palp_hosted_impulses` gives to their momentum, and steps its
 * engine. `palp_contact_events` tells what began to touch and what parted.
 *
 * Recording. `palp_recording_start` hands a function of the host's the state, then every call that changes
 * the world; the `palp_replay_` calls make them again, and tell which comes to something else. The sink is
 * kept in the block, for the block's address: a copy elsewhere records nothing. A block that is copied back
 * to its address has the sink of that time: call `palp_world_attach` then, which ends a recording.
 *
 * Versions. Structs that may grow start with `struct_size`, which the host sets, most easily with the
 * struct's `_INIT` macro; only fields that the host's version has are read or written. Ids are
 * { index1, generation }; zero is null, and an id outlives its thing without harm.
 *
 * Errors. Every call with a status gives PALP_OK, a positive status when it was done but cut short, or
 * a negative one when it was refused and nothing changed. No panic and no bad argument crosses the
 * line: should the library fail inside, it says PALP_PANICKED.
 *
 * Equal calls give equal states, bit for bit, on every processor; `palp_state_hash` compares them.
 */

#ifndef PALPABLE_H
#define PALPABLE_H

#include <stddef.h>
#include <stdint.h>

/** Number of this binary interface; it is part of the symbol of `palp_world_create`. */
#define PALP_ABI 2
#define palp_world_create palp_world_create_abi2

/** No rotation, no translation. */
#define PALP_POSE_IDENTITY { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } }

/** Room for an avatar or two hands with fingers, a furnished room and a few loose objects. */
#define PALP_CAPACITIES_ROOM \
    { (uint32_t)sizeof(palp_capacities), 64, 256, 4096, 1024, 256, 8, 16, 96 }

/** Critically damped, settles in about 0.1 s, detached beyond 0.3 m. */
#define PALP_COUPLING_DEFAULT { 0.4f, 1000.0f, 40.0f, 0.3f, 0, 0.1f, 0 }

/** A fixed body at the origin. */
#define PALP_BODY_DEF_INIT \
    { (uint32_t)sizeof(palp_body_def), PALP_KIND_FIXED, PALP_POSE_IDENTITY, PALP_COUPLING_DEFAULT }

/** A wooden piece in the body's own frame, its shape not yet set. */
#define PALP_PIECE_DEF_INIT \
    { (uint32_t)sizeof(palp_piece_def), 0, NULL, 0, 0, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }, \
      0.0f, 700.0f, PALP_MATERIAL_WOOD, PALP_POSE_IDENTITY }

/** A hinge about X of half a turn each way, at the origin of the link before it. */
#define PALP_JOINT_INIT \
    { (uint32_t)sizeof(palp_joint), PALP_JOINT_HINGE, PALP_POSE_IDENTITY, { 1.0f, 0.0f, 0.0f }, \
      -3.1415927f, 3.1415927f, { 0.0f, 0.0f, 1.0f }, 0, { { 0.0f, 0.0f, 0.0f } } }

/** Least deviation; what the chain cannot evade, the root does. */
#define PALP_CHAIN_OPTIONS_DEFAULT { 0, 1, 0.06f, { 0.0f, 0.0f, 0.0f } }

/** A chain on the body's root, its joints not yet set. */
#define PALP_CHAIN_DEF_INIT \
    { (uint32_t)sizeof(palp_chain_def), 0, NULL, 0, { 0, 0 }, 0, PALP_CHAIN_OPTIONS_DEFAULT }

/** Empty, to be filled in by `palp_chain_report`. */
#define PALP_CHAIN_STATE_INIT { (uint32_t)sizeof(palp_chain_state), 0, 0, 0.0f, 0.0f }

/** A frame of 1/60 s with an unlimited budget. */
#define PALP_FRAME_INPUT_INIT \
    { (uint32_t)sizeof(palp_frame_input), 1.0f / 60.0f, UINT32_MAX, UINT32_MAX, UINT32_MAX, 0, \
      { 0, 0, 0, 0, 0, 0, 0, 0 }, 0, { 0.0f, 0.0f, 0.0f } }

/** Empty, to be filled in by `palp_frame_step`. */
#define PALP_FRAME_REPORT_INIT \
    { (uint32_t)sizeof(palp_frame_report), 0, 0, 0, 0, 0, 0, 0.0f, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/** Empty, to be filled in by `palp_driven_report`. */
#define PALP_DRIVEN_STATE_INIT \
    { (uint32_t)sizeof(palp_driven_state), 0, 0.0f, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } }

/** A still body at the origin that nothing moves, its id not yet set. */
#define PALP_HOSTED_INPUT_INIT \
    { (uint32_t)sizeof(palp_hosted_input), { 0, 0 }, PALP_POSE_IDENTITY, { 0.0f, 0.0f, 0.0f }, \
      { 0.0f, 0.0f, 0.0f }, 0.0f, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }, \
      { 0.0f, 0.0f, 0.0f, 1.0f } }

/** Empty, to be filled in by `palp_hosted_impulse`. */
#define PALP_HOSTED_STATE_INIT \
    { (uint32_t)sizeof(palp_hosted_state), 0, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }, \
      { 0.0f, 0.0f, 0.0f }, 0.0f }

/** Empty, to be filled in by `palp_replay_open`. */
#define PALP_REPLAY_INIT { (uint32_t)sizeof(palp_replay), 0, NULL, 0, 0, 0, 0 }

/** Empty, to be filled in by `palp_replay_next`. */
#define PALP_REPLAYED_INIT { (uint32_t)sizeof(palp_replayed), 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/** Empty. */
#define PALP_CONTACT_INIT \
    { { 0, 0 }, { 0, 0 }, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }, 0.0f, 0.0f, \
      0.0f, 0.0f }

/** Empty, to be filled in by `palp_penetration`. */
#define PALP_PENETRATION_RESULT_INIT \
    { (uint32_t)sizeof(palp_penetration_result), 0, 0.0f, 0.0f, { 0.0f, 0.0f, 0.0f }, \
      { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }, { 0, 0 }, { 0, 0 }, \
      { PALP_CONTACT_INIT, PALP_CONTACT_INIT, PALP_CONTACT_INIT, PALP_CONTACT_INIT } }

/**
 * Alignment of a world's block, in bytes.
 */
#define PALP_BLOCK_ALIGNMENT 64

/**
 * Most points of a hull.
 */
#define PALP_POINTS_MAX 512

/**
 * Never moves; only `palp_body_place` moves it.
 */
#define PALP_KIND_FIXED 1

/**
 * Moved by impulses and gravity.
 */
#define PALP_KIND_DYNAMIC 2

/**
 * Follows a tracker, and never into a fixed body.
 */
#define PALP_KIND_DRIVEN 3

/**
 * Moved by the host's own physics engine, which tells of it with `palp_hosted_set` before each frame and
 * applies what `palp_hosted_impulse` gives before its own step.
 */
#define PALP_KIND_HOSTED 4

/**
 * A detached body stays where contact holds it.
 */
#define PALP_SNAP_NEVER 0

/**
 * A detached body jumps to its tracker as soon as nothing is in the way there.
 */
#define PALP_SNAP_WHEN_FREE 1

/**
 * A detached body jumps to the place nearest to its tracker where nothing is in the way, as soon as there is one within
 * half of `divergence_m`: one that stands on a floor, or whose tracker is in a table top, does so too.
 */
#define PALP_SNAP_NEAR 2

/**
 * The body pushes what is free as if it had no end of mass: without lag.
 */
#define PALP_PUSH_WITHOUT_LAG 0

/**
 * The body pushes with the mass of its spring, and gives way to what is heavy.
 */
#define PALP_PUSH_WITH_MASS 1

/**
 * A point at the piece's origin: with the radius, a sphere.
 */
#define PALP_SHAPE_POINT 1

/**
 * The segment from `a` to `b`: with the radius, a capsule.
 */
#define PALP_SHAPE_SEGMENT 2

/**
 * A box with half extents `a`, centred; with a radius, rounded outward.
 */
#define PALP_SHAPE_BOX 3

/**
 * The hull of `points`; with a radius, rounded outward.
 */
#define PALP_SHAPE_HULL 4

/**
 * Built-in material: wood.
 */
#define PALP_MATERIAL_WOOD 0

/**
 * Built-in material: skin.
 */
#define PALP_MATERIAL_HUMAN 1

/**
 * Built-in material: metal.
 */
#define PALP_MATERIAL_METAL 2

/**
 * The time step was not a positive number: nothing moved.
 */
#define PALP_FRAME_BAD_TIME_STEP 1

/**
 * The time step was clamped.
 */
#define PALP_FRAME_TIME_STEP_CLAMPED 2

/**
 * A driven body's way was cut by the budget.
 */
#define PALP_FRAME_CUT_ADVANCE 4

/**
 * Loose bodies were stopped early by the budget or by the bound on events.
 */
#define PALP_FRAME_CUT_IMPULSES 8

/**
 * Pairs were left out and their movers held: raise `palp_capacities.pairs`.
 */
#define PALP_FRAME_FULL_PAIRS 16

/**
 * Contacts were left out: raise `palp_capacities.contacts`.
 */
#define PALP_FRAME_FULL_CONTACTS 32

/**
 * A driven body overlaps a fixed one where the host put it.
 */
#define PALP_FRAME_OVERLAP 64

/**
 * The steps for chains were used up: raise `palp_frame_input.reach_steps`.
 */
#define PALP_FRAME_CUT_REACH 128

/**
 * The frame's time was used up, by `palp_frame_input.costs`.
 */
#define PALP_FRAME_OUT_OF_TIME 256

/**
 * The clock of `palp_frame_step_by_clock` ended the frame's work. Stepping with the units of this report
 * and no deadline gives the same bits.
 */
#define PALP_FRAME_LATE 512

/**
 * The deadline is shorter than the frame's floor: no unit was spent.
 */
#define PALP_FRAME_BELOW_FLOOR 1024

/**
 * The calling thread puts numbers below 1.2e-38 to zero, and the library cannot switch that off on this
 * processor: bits may not be those of other machines. Never set on x86-64 and 64-bit Arm.
 */
#define PALP_FRAME_FLUSHES_TO_ZERO 2048

/**
 * Contact bent or ended the body's way.
 */
#define PALP_DRIVEN_TOUCHING 1

/**
 * The body stayed exactly where it was.
 */
#define PALP_DRIVEN_HELD 2

/**
 * The body is farther from its tracker than `palp_coupling.divergence_m`.
 */
#define PALP_DRIVEN_DETACHED 4

/**
 * The tracker has been lost for longer than `palp_coupling.grace_s`.
 */
#define PALP_DRIVEN_LOST 8

/**
 * The budget ended the body's way early, or a loose body did between two postures within the reach cones; the
 * rest follows next frame.
 */
#define PALP_DRIVEN_CUT 16

/**
 * The host placed things so that the body overlaps a fixed one, and no way out was found yet.
 */
#define PALP_DRIVEN_OVERLAPS 32

/**
 * A pool was full: the body stayed where it was.
 */
#define PALP_DRIVEN_POOL_FULL 64

/**
 * There was no room for all contacts that `palp_contacts` can give.
 */
#define PALP_DRIVEN_CONTACTS_FULL 128

/**
 * The pieces did not touch in the frame before.
 */
#define PALP_EVENT_BEGIN 1

/**
 * The pieces touched in the frame before, and still do.
 */
#define PALP_EVENT_STAY 2

/**
 * The pieces do not touch any more.
 */
#define PALP_EVENT_END 3

/**
 * Most contacts between one pair of pieces.
 */
#define PALP_PAIR_CONTACTS 4

/**
 * Joints of a hand in OpenXR: `XR_HAND_JOINT_COUNT_EXT`.
 */
#define PALP_HAND_JOINTS 26

/**
 * Most hinges of a chain; a ball is three.
 */
#define PALP_CHAIN_HINGES_MAX 16

/**
 * Most chains of a body.
 */
#define PALP_CHAINS_PER_BODY_MAX 32

/**
 * Most joints of a human limb or finger.
 */
#define PALP_LIMB_JOINTS_MAX 5

/**
 * Most corners of a reach cone.
 */
#define PALP_CONE_CORNERS_MAX 12

/**
 * A joint with one axis: one hinge of the chain, one angle.
 */
#define PALP_JOINT_HINGE 1

/**
 * Three hinges in one place with the axes X, Y and Z of the rest frame, three angles: Z turned by the
 * first two is the limb, the third is the twist about it. At angles a and b of the first two the limb
 * is (sin b, -sin a cos b, cos a cos b) in the rest frame.
 */
#define PALP_JOINT_BALL 2

/**
 * The least change from the tracked angles.
 */
#define PALP_METHOD_LEAST_DEVIATION 0

/**
 * Cyclic coordinate descent, the method of Schmidl and Lin 2004, begun with what contact did in the last frame.
 */
#define PALP_METHOD_CYCLIC_DESCENT 1

/**
 * What the chain cannot evade, the body's root does.
 */
#define PALP_OPTION_MOVES_ROOT 1

/**
 * The chain's links keep out of the links of other chains of the body, and of its root, where those do
 * so too. The root always does.
 */
#define PALP_OPTION_MEETS_BODY 2

/**
 * The tip is kept at its tracked place, along the surface that it touches; the joints give way instead.
 */
#define PALP_OPTION_HOLDS_TIP 4

/**
 * Contact moves the root alone: the joints follow the tracked angles, as a rigid group does.
 */
#define PALP_OPTION_RIGID 8

/**
 * Among chains that hang on the same, this one's turn comes by a number drawn from frame and chain instead
 * of by how deep it is.
 */
#define PALP_OPTION_SHUFFLED 16

/**
 * Contact changed the chain's angles.
 */
#define PALP_CHAIN_BENT 1

/**
 * The solver met no posture outside all contact planes.
 */
#define PALP_CHAIN_MISSED 2

/**
 * The budget ended the solver early.
 */
#define PALP_CHAIN_CUT 4

/**
 * The chain stayed as it was for a part of the frame: no way was found.
 */
#define PALP_CHAIN_HELD 8

/**
 * Trunk, from the root. With `PALP_LIMB_ON_ROOT` there is none.
 */
#define PALP_LIMB_SPINE 0

/**
 * Neck and head.
 */
#define PALP_LIMB_NECK 1

/**
 * Left arm: ball shoulder, elbow, forearm's twist, wrist of two.
 */
#define PALP_LIMB_LEFT_ARM 2

/**
 * Right arm.
 */
#define PALP_LIMB_RIGHT_ARM 3

/**
 * Left leg: ball hip, knee, ankle of two.
 */
#define PALP_LIMB_LEFT_LEG 4

/**
 * Right leg.
 */
#define PALP_LIMB_RIGHT_LEG 5

/**
 * Thumb: five hinges.
 */
#define PALP_FINGER_THUMB 0

/**
 * Index finger: knuckle of two, two more.
 */
#define PALP_FINGER_INDEX 1

/**
 * Middle finger.
 */
#define PALP_FINGER_MIDDLE 2

/**
 * Ring finger.
 */
#define PALP_FINGER_RING 3

/**
 * Little finger.
 */
#define PALP_FINGER_LITTLE 4

/**
 * A world. Its handle is the address of the block it lies in, which is the host's memory: there is
 * no call to destroy it, and a copy of the block at another address is a second world.
 */
typedef struct palp_world palp_world;

/**
 * What a call came to: zero is fine, positive is done but cut short, negative is refused with
 * nothing changed. A number never gets a second meaning.
 */
typedef int32_t palp_status;

/**
 * How much of everything a world has room for. Start from `PALP_CAPACITIES_ROOM`, ship what
 * `palp_high_water` says.
 */
typedef struct palp_capacities {
    /**
     * `sizeof(palp_capacities)`.
     */
    uint32_t struct_size;
    /**
     * Bodies of all kinds.
     */
    uint32_t bodies;
    /**
     * Pieces of all bodies.
     */
    uint32_t pieces;
    /**
     * Vertices of all pieces: a point has 1, a segment 2, a box 8.
     */
    uint32_t vertices;
    /**
     * Pairs of pieces that may touch within one frame, and gaps that driven bodies remember when one is cut.
     */
    uint32_t pairs;
    /**
     * Contacts of loose bodies within one frame, and contacts that `palp_contacts` can give.
     */
    uint32_t contacts;
    /**
     * Materials that the host adds.
     */
    uint32_t materials;
    /**
     * Chains of joints of all bodies.
     */
    uint32_t chains;
    /**
     * Hinges of all chains; a ball joint is three.
     */
    uint32_t joints;
} palp_capacities;

/**
 * Three coordinates. The same in memory as `XrVector3f`.
 */
typedef struct palp_vec3 {
    /**
     * Right.
     */
    float x;
    /**
     * Up.
     */
    float y;
    /**
     * Backward.
     */
    float z;
} palp_vec3;

/**
 * A rotation. The same in memory as `XrQuaternionf`. Need not have unit length where the host gives
 * it: lengths from 0.001 to 1000 are normalised.
 */
typedef struct palp_quat {
    /**
     * First imaginary part.
     */
    float x;
    /**
     * Second imaginary part.
     */
    float y;
    /**
     * Third imaginary part.
     */
    float z;
    /**
     * Real part.
     */
    float w;
} palp_quat;

/**
 * Where a thing is. 28 bytes, the same in memory as `XrPosef`.
 */
typedef struct palp_pose {
    /**
     * Orientation.
     */
    struct palp_quat orientation;
    /**
     * Position in metres.
     */
    struct palp_vec3 position;
} palp_pose;

/**
 * The spring between a tracker and a driven body. It carries only what contact forces: free motion
 * does not lag.
 */
typedef struct palp_coupling {
    /**
     * Mass in kg, above 0.
     */
    float mass_kg;
    /**
     * Stiffness in N/m, 0 or more.
     */
    float stiffness_n_per_m;
    /**
     * Damping in N s/m, 0 or more.
     */
    float damping_n_s_per_m;
    /**
     * How far body and tracker may be apart before the body counts as detached, in metres, above 0.
     */
    float divergence_m;
    /**
     * What happens then: `PALP_SNAP_NEVER`, `PALP_SNAP_WHEN_FREE` or `PALP_SNAP_NEAR`.
     */
    uint32_t snap;
    /**
     * How long a lost tracker's last target is kept before the body counts as lost, in seconds.
     */
    float grace_s;
    /**
     * How the body pushes loose ones: `PALP_PUSH_WITHOUT_LAG` or `PALP_PUSH_WITH_MASS`.
     */
    uint32_t push;
} palp_coupling;

/**
 * What a body is made from. Start from `PALP_BODY_DEF_INIT`.
 */
typedef struct palp_body_def {
    /**
     * `sizeof(palp_body_def)`.
     */
    uint32_t struct_size;
    /**
     * `PALP_KIND_FIXED`, `PALP_KIND_DYNAMIC`, `PALP_KIND_DRIVEN` or `PALP_KIND_HOSTED`.
     */
    uint32_t kind;
    /**
     * Where it is.
     */
    struct palp_pose pose;
    /**
     * The spring of a driven body; not looked at for others.
     */
    struct palp_coupling coupling;
} palp_body_def;

/**
 * Names a body. All zeros is null. A stale id is refused.
 */
typedef struct palp_body_id {
    /**
     * Index of the slot plus one; zero is null.
     */
    uint32_t index1;
    /**
     * How often the slot has been used.
     */
    uint32_t generation;
} palp_body_id;

/**
 * What the last frame did to a driven body. Start from `PALP_DRIVEN_STATE_INIT`.
 */
typedef struct palp_driven_state {
    /**
     * `sizeof(palp_driven_state)`.
     */
    uint32_t struct_size;
    /**
     * `PALP_DRIVEN_` bits.
     */
    uint32_t flags;
    /**
     * How far contact holds the body from its target, in metres.
     */
    float displacement_m;
    /**
     * Force of the coupling on the hand, in newtons, in the world: the haptic signal.
     */
    struct palp_vec3 force_n;
    /**
     * Mean force of loose bodies on the body over the frame, in newtons, in the world. A body that pushes
     * without lag feels it here alone; one that gives way feels it in its coupling too.
     */
    struct palp_vec3 reaction_n;
} palp_driven_state;

/**
 * A body of the host's own physics engine, as the host has it before a frame. Start from
 * `PALP_HOSTED_INPUT_INIT`.
 */
typedef struct palp_hosted_input {
    /**
     * `sizeof(palp_hosted_input)`.
     */
    uint32_t struct_size;
    /**
     * A body of the kind `PALP_KIND_HOSTED`.
     */
    struct palp_body_id body;
    /**
     * Where it is.
     */
    struct palp_pose pose;
    /**
     * Velocity of its centre of mass, in m/s, at most 1000 a coordinate.
     */
    struct palp_vec3 velocity_m_s;
    /**
     * Angular velocity in the world, in rad/s, at most 3000 a coordinate.
     */
    struct palp_vec3 spin_rad_s;
    /**
     * Mass in kg, 1e-9 to 1e9; 0 for a body that nothing moves.
     */
    float mass_kg;
    /**
     * Centre of mass in the body's frame, in metres.
     */
    struct palp_vec3 centre;
    /**
     * Principal moments of inertia about the centre of mass, in kg m2, 1e-9 to 1e9; not looked at when
     * `mass_kg` is 0.
     */
    struct palp_vec3 moments_kg_m2;
    /**
     * Orientation of the principal axes in the body's frame.
     */
    struct palp_quat axes;
} palp_hosted_input;

/**
 * The first of several entries that was refused.
 */
typedef struct palp_refusal {
    /**
     * Its place among those given, from 0; their number when none was refused.
     */
    uint32_t index;
    /**
     * Why; PALP_OK when none was refused.
     */
    palp_status status;
} palp_refusal;

/**
 * What hands did to a hosted body in the last frame. Start from `PALP_HOSTED_STATE_INIT`.
 */
typedef struct palp_hosted_state {
    /**
     * `sizeof(palp_hosted_state)`.
     */
    uint32_t struct_size;
    /**
     * Contacts that carried an impulse.
     */
    uint32_t contacts;
    /**
     * Impulse of the driven and dynamic bodies on it, in newton seconds, in the world.
     */
    struct palp_vec3 impulse_n_s;
    /**
     * Their angular impulse about its centre of mass, in newton metre seconds, in the world.
     */
    struct palp_vec3 angular_n_m_s;
    /**
     * Mean of the contacts' points, weighted by their normal impulses, in the world, in metres; says nothing
     * when `contacts` is 0. The two impulses are all that an engine needs; this is where they came from.
     */
    struct palp_vec3 point;
    /**
     * Sum of the contacts' normal impulses, in newton seconds.
     */
    float push_n_s;
} palp_hosted_state;

/**
 * What a piece is made from. Start from `PALP_PIECE_DEF_INIT`.
 */
typedef struct palp_piece_def {
    /**
     * `sizeof(palp_piece_def)`.
     */
    uint32_t struct_size;
    /**
     * One of the `PALP_SHAPE_` numbers.
     */
    uint32_t shape;
    /**
     * Points of a hull in metres, each three floats; read during the call only. Those inside the
     * hull are left out.
     */
    const float *points;
    /**
     * Number of points, 4 to `PALP_POINTS_MAX`.
     */
    uint32_t point_count;
    /**
     * Bytes from one point to the next, a multiple of 4; 0 stands for 12.
     */
    uint32_t point_stride;
    /**
     * One end of a segment, or half extents of a box, in metres.
     */
    struct palp_vec3 a;
    /**
     * Other end of a segment, in metres.
     */
    struct palp_vec3 b;
    /**
     * Rounding radius in metres, 0 or more.
     */
    float radius_m;
    /**
     * Density in kg/m3, above 0 and at most 1e9; looked at for dynamic bodies only.
     */
    float density_kg_m3;
    /**
     * A `PALP_MATERIAL_` number or one from `palp_material_add`.
     */
    uint32_t material;
    /**
     * Pose in the body's frame.
     */
    struct palp_pose local_pose;
} palp_piece_def;

/**
 * Names a piece. All zeros is null. A stale id is refused.
 */
typedef struct palp_piece_id {
    /**
     * Index of the slot plus one; zero is null. `index1 - 1` is the index in `palp_piece_poses`.
     */
    uint32_t index1;
    /**
     * How often the slot has been used.
     */
    uint32_t generation;
} palp_piece_id;

/**
 * A joint as a chain is made from it. Start from `PALP_JOINT_INIT`.
 */
typedef struct palp_joint {
    /**
     * `sizeof(palp_joint)`.
     */
    uint32_t struct_size;
    /**
     * `PALP_JOINT_HINGE` or `PALP_JOINT_BALL`.
     */
    uint32_t kind;
    /**
     * Pose at angle zero in the frame of the link before it; of the first joint, in the frame of what
     * the chain hangs on.
     */
    struct palp_pose rest_pose;
    /**
     * Axis of a hinge in the rest frame, of any length; not looked at for a ball.
     */
    struct palp_vec3 axis;
    /**
     * Least angle of a hinge, or least twist of a ball, in radians, -6.2831853 or more.
     */
    float low_rad;
    /**
     * Largest angle of a hinge, or largest twist of a ball, in radians, 6.2831853 or less.
     */
    float high_rad;
    /**
     * Direction of any length within a ball's reach cone from which every edge of the cone is seen, in
     * the rest frame; not looked at for a hinge.
     */
    struct palp_vec3 cone_visible;
    /**
     * Corners of a ball's reach cone, 3 to `PALP_CONE_CORNERS_MAX`; not looked at for a hinge.
     */
    uint32_t cone_corner_count;
    /**
     * Directions of any length in the rest frame, in order, either way round: the limb stays within the
     * polygon of great arcs between them. It need not be convex, and may be wider than a hemisphere.
     */
    struct palp_vec3 cone_corners[PALP_CONE_CORNERS_MAX];
} palp_joint;

/**
 * Names a chain. All zeros is null. A stale id is refused.
 */
typedef struct palp_chain_id {
    /**
     * Index of the slot plus one; zero is null.
     */
    uint32_t index1;
    /**
     * How often the slot has been used.
     */
    uint32_t generation;
} palp_chain_id;

/**
 * How a chain answers contact. Start from `PALP_CHAIN_OPTIONS_DEFAULT`.
 */
typedef struct palp_chain_options {
    /**
     * `PALP_METHOD_LEAST_DEVIATION` or `PALP_METHOD_CYCLIC_DESCENT`.
     */
    uint32_t method;
    /**
     * Bits `PALP_OPTION_*`.
     */
    uint32_t flags;
    /**
     * Time constant of the return to the tracked angles once contact lets go, in seconds, 0 to 1e6: the
     * deviation left after h seconds is exp(-h / attraction_s).
     */
    float attraction_s;
    /**
     * With `PALP_OPTION_HOLDS_TIP`: the point of the last link that is held, in that link's frame, in
     * metres.
     */
    struct palp_vec3 tip;
} palp_chain_options;

/**
 * What a chain is made from. Start from `PALP_CHAIN_DEF_INIT`.
 */
typedef struct palp_chain_def {
    /**
     * `sizeof(palp_chain_def)`.
     */
    uint32_t struct_size;
    /**
     * Number of joints, at least 1. Their hinges are at most `PALP_CHAIN_HINGES_MAX`.
     */
    uint32_t joint_count;
    /**
     * Joints from the base on; read during the call only.
     */
    const struct palp_joint *joints;
    /**
     * Bytes from one joint to the next; 0 stands for `joints->struct_size`.
     */
    uint32_t joint_stride;
    /**
     * Chain of the same body that the new one hangs on; null for the body's root.
     */
    struct palp_chain_id base;
    /**
     * Hinge of `base` whose link that is, from 0; not looked at when `base` is null.
     */
    uint32_t base_hinge;
    /**
     * How the chain answers contact.
     */
    struct palp_chain_options options;
} palp_chain_def;

/**
 * What the last frame did to a chain. Start from `PALP_CHAIN_STATE_INIT`.
 */
typedef struct palp_chain_state {
    /**
     * `sizeof(palp_chain_state)`.
     */
    uint32_t struct_size;
    /**
     * `PALP_CHAIN_BENT`, `PALP_CHAIN_MISSED`, `PALP_CHAIN_CUT` and `PALP_CHAIN_HELD`.
     */
    uint32_t flags;
    /**
     * Steps of the solver that were spent.
     */
    uint32_t steps;
    /**
     * The most that a contact's plane is still violated by in the plan, in metres. The published
     * posture overlaps nothing all the same: the way ends before.
     */
    float missed_m;
    /**
     * The most that any angle is from its tracked one, in radians.
     */
    float deviation_rad;
} palp_chain_state;

/**
 * What work costs on the host's machine, in nanoseconds: measured worst cases with a margin, not
 * guarantees. A unit's price covers all that a stage does between two units. All zero costs nothing.
 */
typedef struct palp_costs {
    /**
     * A frame of an empty world.
     */
    uint32_t frame_ns;
    /**
     * Each body, whatever it does.
     */
    uint32_t body_ns;
    /**
     * Each piece, whatever it does.
     */
    uint32_t piece_ns;
    /**
     * Each chain, whatever it does.
     */
    uint32_t chain_ns;
    /**
     * Each 256 tests of two boxes against each other.
     */
    uint32_t boxes_ns;
    /**
     * A unit of `palp_frame_input.advance_units`.
     */
    uint32_t advance_unit_ns;
    /**
     * A unit of `palp_frame_input.impulse_units`.
     */
    uint32_t impulse_unit_ns;
    /**
     * A step of `palp_frame_input.reach_steps`.
     */
    uint32_t reach_step_ns;
} palp_costs;

/**
 * What a frame is given. Start from `PALP_FRAME_INPUT_INIT`.
 */
typedef struct palp_frame_input {
    /**
     * `sizeof(palp_frame_input)`.
     */
    uint32_t struct_size;
    /**
     * Time since the frame before, in seconds. Kept between 0.0001 and 0.1; not above zero is
     * refused.
     */
    float dt_s;
    /**
     * Work that may be spent on driven bodies; one unit is one distance query between two ordinary pieces,
     * and more with many vertices.
     */
    uint32_t advance_units;
    /**
     * Work that may be spent on loose bodies, in the same units; eight impulses make one as well.
     */
    uint32_t impulse_units;
    /**
     * Steps that may be spent on chains that touch something: a sweep of cyclic descent, or a step of
     * least deviation. A chain that gets none goes as far as contact lets its joints follow the trackers.
     */
    uint32_t reach_steps;
    /**
     * How long the frame may take by `costs`, in nanoseconds; zero for as long as its units last. The floor
     * (`palp_frame_floor`) is paid first, then driven bodies, then loose ones, for which a quarter is kept
     * while any is awake. A deadline below the floor publishes the last safe poses.
     */
    uint32_t deadline_ns;
    /**
     * What work costs.
     */
    struct palp_costs costs;
    /**
     * One when `focus` is where the viewer looks, in the world: when time is short, what is near goes first.
     */
    uint32_t has_focus;
    struct palp_vec3 focus;
} palp_frame_input;

/**
 * What a frame did. Start from `PALP_FRAME_REPORT_INIT`.
 */
typedef struct palp_frame_report {
    /**
     * `sizeof(palp_frame_report)`.
     */
    uint32_t struct_size;
    /**
     * `PALP_FRAME_` bits.
     */
    uint32_t flags;
    /**
     * Frames stepped so far, this one included.
     */
    uint64_t frame;
    /**
     * Units spent on driven bodies.
     */
    uint32_t advance_units;
    /**
     * Units spent on loose bodies.
     */
    uint32_t impulse_units;
    /**
     * Contacts that `palp_contacts` gives.
     */
    uint32_t contacts;
    /**
     * Impulses applied.
     */
    uint32_t impulses;
    /**
     * Time by which loose bodies were stopped before the end of the frame, at most, in seconds.
     */
    float lost_s;
    /**
     * Steps spent on chains; none while nothing touches one.
     */
    uint32_t reach_steps;
    /**
     * Contact events that `palp_contact_events` gives.
     */
    uint32_t events;
    /**
     * Contact events that found no room: raise `palp_capacities.contacts`.
     */
    uint32_t events_dropped;
    /**
     * Driven bodies whose way was cut: the rest follows, before all others, in the next frame.
     */
    uint32_t driven_cut;
    /**
     * Chains that got fewer steps than they wanted.
     */
    uint32_t chains_cut;
    /**
     * Loose bodies that were stopped before the end of the frame.
     */
    uint32_t loose_cut;
    /**
     * Bodies of both kinds that were to move and have the poses of the last frame because there was no
     * time for them.
     */
    uint32_t kept;
    /**
     * What the frame costs whatever happens, by the input's prices, in nanoseconds; zero without a
     * deadline.
     */
    uint32_t floor_ns;
    /**
     * What it cost by those prices, at most `UINT32_MAX`.
     */
    uint32_t priced_ns;
} palp_frame_report;

/**
 * A clock of the host's that runs forward, in nanoseconds from any start. Called from the stepping thread,
 * before every unit; it must not call this library.
 */
typedef uint64_t (*palp_clock)(void *user);

/**
 * A contact of the last frame.
 */
typedef struct palp_contact {
    /**
     * Piece of the driven or dynamic body.
     */
    struct palp_piece_id piece_a;
    /**
     * Piece of the other body.
     */
    struct palp_piece_id piece_b;
    /**
     * Midway between the surfaces, in the world, in metres.
     */
    struct palp_vec3 point;
    /**
     * From B into A, unit length.
     */
    struct palp_vec3 normal;
    /**
     * Distance of the surfaces in metres; negative is overlap.
     */
    float gap_m;
    /**
     * Impulse on A along the normal during the frame, in newton seconds; zero for driven against
     * fixed.
     */
    float impulse_n_s;
    /**
     * Fastest approach of the surfaces in the frame before an impulse, in m/s; zero for driven against
     * fixed.
     */
    float approach_m_s;
    /**
     * Speed of the surfaces along each other, in m/s.
     */
    float slide_m_s;
} palp_contact;

/**
 * Two pieces that began to touch, still do, or came apart: for haptics and sound.
 */
typedef struct palp_contact_event {
    /**
     * `PALP_EVENT_BEGIN`, `PALP_EVENT_STAY` or `PALP_EVENT_END`.
     */
    uint32_t kind;
    /**
     * Piece of the driven or loose body. After an end it may be gone.
     */
    struct palp_piece_id piece_a;
    /**
     * Piece of the other body.
     */
    struct palp_piece_id piece_b;
    /**
     * Material of A: a `PALP_MATERIAL_` number or one from `palp_material_add`.
     */
    uint32_t material_a;
    /**
     * Material of B.
     */
    uint32_t material_b;
    /**
     * Mean of the contacts' points, weighted by their impulses, in the world, in metres; after an end the
     * last one.
     */
    struct palp_vec3 point;
    /**
     * From B into A at the contact with the largest impulse, unit length.
     */
    struct palp_vec3 normal;
    /**
     * Sum of the normal impulses during the frame, in newton seconds; zero for driven against fixed.
     */
    float impulse_n_s;
    /**
     * Fastest approach before an impulse, in m/s: how hard the pieces met.
     */
    float approach_m_s;
    /**
     * Fastest slip, in m/s.
     */
    float slide_m_s;
} palp_contact_event;

/**
 * How two bodies lie to each other. Start from `PALP_PENETRATION_RESULT_INIT`.
 */
typedef struct palp_penetration_result {
    /**
     * `sizeof(palp_penetration_result)`.
     */
    uint32_t struct_size;
    /**
     * How many of `contacts` there are; none when the bodies are apart.
     */
    uint32_t contact_count;
    /**
     * Length of the least translation of A that parts the bodies, in metres; zero when they are apart.
     */
    float depth_m;
    /**
     * Distance of the bodies in metres; zero when they overlap, infinite when one has no pieces.
     */
    float distance_m;
    /**
     * From B into A, unit length: along the least translation, or between the closest points. Zero when
     * a body has no pieces.
     */
    struct palp_vec3 normal;
    /**
     * Where A's surface is nearest to B, or deepest in it, in the world, in metres.
     */
    struct palp_vec3 point_a;
    /**
     * Where B's surface is nearest to A, or deepest in it, in the world, in metres.
     */
    struct palp_vec3 point_b;
    /**
     * A's piece of the nearest, or deepest, pair; null when a body has no pieces.
     */
    struct palp_piece_id piece_a;
    /**
     * B's piece of that pair.
     */
    struct palp_piece_id piece_b;
    /**
     * Contacts of that pair, with that pair's own normal. Their impulse is zero.
     */
    struct palp_contact contacts[PALP_PAIR_CONTACTS];
} palp_penetration_result;

/**
 * Takes the next `size` bytes of a log, which are good during the call alone. What it does when there is no
 * room for them is the host's. It must return, and must not use the world that is recorded: a call with it
 * gives `PALP_INSIDE_SINK`.
 */
typedef void (*palp_sink)(void *user, const void *bytes, size_t size);

/**
 * A log that is replayed. Start from `PALP_REPLAY_INIT`; the library fills it in, and the host may copy it
 * to come back to where it was.
 */
typedef struct palp_replay {
    /**
     * `sizeof(palp_replay)`.
     */
    uint32_t struct_size;
    /**
     * 0.
     */
    uint32_t reserved;
    /**
     * The log, which stays the host's.
     */
    const void *log;
    /**
     * Its bytes.
     */
    size_t size;
    /**
     * Where the next call begins in it, in bytes; behind a negative status the call that was refused.
     */
    uint64_t at;
    /**
     * Calls made.
     */
    uint64_t calls;
    /**
     * Frames stepped.
     */
    uint64_t frames;
} palp_replay;

/**
 * A call that was made again. Start from `PALP_REPLAYED_INIT`.
 *
 * A value is what the call gave: for a frame `palp_state_hash` behind it; an id as its index plus its
 * generation times 2^32; the bits of a float. A refusal is 0 for a call that was accepted, and else tells
 * reasons apart. Flags are those of a frame's report.
 */
typedef struct palp_replayed {
    /**
     * `sizeof(palp_replayed)`.
     */
    uint32_t struct_size;
    /**
     * Which call: `palp_call_name` knows it.
     */
    uint32_t kind;
    /**
     * Its number in the log, counted from 1.
     */
    uint64_t call;
    /**
     * The number of the frame that it belongs to in the log, counted from 1: what is told before a frame
     * belongs to it.
     */
    uint64_t frame;
    /**
     * When it was recorded.
     */
    uint64_t recorded_value;
    /**
     * Now.
     */
    uint64_t replayed_value;
    /**
     * When it was recorded.
     */
    uint32_t recorded_refusal;
    /**
     * Now.
     */
    uint32_t replayed_refusal;
    /**
     * When it was recorded.
     */
    uint32_t recorded_flags;
    /**
     * Now.
     */
    uint32_t replayed_flags;
} palp_replayed;

/**
 * Done.
 */
#define PALP_OK 0

/**
 * Stepped, with the time step clamped to 0.0001 to 0.1 s.
 */
#define PALP_TIME_STEP_CLAMPED 1

/**
 * Stepped; loose bodies stopped early: raise `palp_frame_input.impulse_units`.
 */
#define PALP_CUT_IMPULSES 2

/**
 * Stepped; a driven body's way was cut and goes on next frame: raise `palp_frame_input.advance_units`.
 */
#define PALP_CUT_ADVANCE 3

/**
 * Stepped; contacts were left out: raise `palp_capacities.contacts`.
 */
#define PALP_FULL_CONTACTS 4

/**
 * Stepped; pairs were left out and their movers held: raise `palp_capacities.pairs`.
 */
#define PALP_FULL_PAIRS 5

/**
 * Stepped; a driven body overlaps a fixed one where the host put it.
 */
#define PALP_OVERLAP 6

/**
 * Set; pieces whose joints were not good keep their last targets.
 */
#define PALP_JOINTS_IGNORED 7

/**
 * Nothing set, because the wrist was not good: the next frame counts the tracker as lost.
 */
#define PALP_TRACKING_LOST 8

/**
 * Answered for a part of the pairs of pieces in the way: the depth may be too small to part the bodies.
 */
#define PALP_PAIRS_LEFT_OUT 9

/**
 * Stepped; chains in contact got fewer steps than they wanted: raise `palp_frame_input.reach_steps`.
 */
#define PALP_CUT_REACH 10

/**
 * Done for every entry but those that were refused; `palp_refusal` names the first of them.
 */
#define PALP_ENTRIES_REFUSED 11

/**
 * Nothing done: the log has no more calls.
 */
#define PALP_REPLAY_END 16

/**
 * Done, and the call came to something else than it did when it was recorded.
 */
#define PALP_REPLAY_DIFFERS 17

/**
 * Stepped; the frame's time was used up by the input's prices: raise `palp_frame_input.deadline_ns`.
 */
#define PALP_OUT_OF_TIME 12

/**
 * Stepped; the clock ended the frame's work.
 */
#define PALP_LATE 13

/**
 * Stepped; the deadline is shorter than the frame's floor, and nothing was spent on contact.
 */
#define PALP_BELOW_FLOOR 14

/**
 * Stepped; the thread puts small numbers to zero, which may change bits.
 */
#define PALP_FLUSHES_TO_ZERO 15

/**
 * The library failed inside. The world may be half changed: load a saved state or create it anew.
 */
#define PALP_PANICKED -1

/**
 * A pointer that must not be null is null.
 */
#define PALP_NULL -2

/**
 * A pointer is not aligned to its type, or a block not to `PALP_BLOCK_ALIGNMENT`.
 */
#define PALP_MISALIGNED -3

/**
 * A `struct_size` is not that of any version of the struct, or a field that this library does not
 * know is not zero.
 */
#define PALP_BAD_STRUCT_SIZE -4

/**
 * A number names no kind, shape or policy.
 */
#define PALP_BAD_ENUM -5

/**
 * The block is shorter than `palp_memory_bytes` says.
 */
#define PALP_MEMORY_TOO_SMALL -6

/**
 * A capacity is beyond what any world may have.
 */
#define PALP_CAPACITY_TOO_LARGE -7

/**
 * The block holds no world.
 */
#define PALP_NOT_A_WORLD -8

/**
 * The world, the saved state or the log was made by a library with another memory layout, or the state
 * with other capacities.
 */
#define PALP_OTHER_LAYOUT -9

/**
 * The head of a world, or a part of a saved state or of a log, contradicts its checksum.
 */
#define PALP_DAMAGED -10

/**
 * The id names no body of this world.
 */
#define PALP_STALE_BODY -11

/**
 * The id names no piece of this world.
 */
#define PALP_STALE_PIECE -12

/**
 * The body is of a kind that this cannot be done to.
 */
#define PALP_WRONG_KIND -13

/**
 * A pose is not finite, farther than 1024 m from the origin, or without orientation.
 */
#define PALP_BAD_POSE -14

/**
 * There are not as many entries as the body has pieces, or as the chain has hinges or joints; or a
 * chain is to have no joint, or more than `PALP_CHAIN_HINGES_MAX` hinges.
 */
#define PALP_WRONG_COUNT -15

/**
 * The coupling's mass or divergence is not above zero, another of its numbers is negative, or one
 * is not finite.
 */
#define PALP_BAD_COUPLING -16

/**
 * A number is outside its range.
 */
#define PALP_BAD_NUMBER -17

/**
 * A number is not finite.
 */
#define PALP_NOT_FINITE -18

/**
 * A coordinate or a radius is beyond 10 km.
 */
#define PALP_TOO_LARGE -19

/**
 * Fewer points than a hull needs.
 */
#define PALP_TOO_FEW_POINTS -20

/**
 * More points than `PALP_POINTS_MAX`.
 */
#define PALP_TOO_MANY_POINTS -21

/**
 * The shape is flat, or a point or segment without radius, or a box without extent.
 */
#define PALP_DEGENERATE -22

/**
 * The world has no such material.
 */
#define PALP_UNKNOWN_MATERIAL -23

/**
 * The restitution is outside 0 to 1, or the friction outside 0 to 1e6.
 */
#define PALP_BAD_SURFACE -24

/**
 * The time step is not a positive number: nothing moved.
 */
#define PALP_BAD_TIME_STEP -25

/**
 * A stride is shorter than what lies in it, or not a multiple of the alignment.
 */
#define PALP_BAD_STRIDE -26

/**
 * The buffer is shorter than `palp_state_bytes` says.
 */
#define PALP_BUFFER_TOO_SMALL -27

/**
 * A piece names a joint that a hand, or a hinge that the chain, does not have.
 */
#define PALP_UNKNOWN_JOINT -28

/**
 * An array or buffer of the host reaches into the world's block.
 */
#define PALP_INSIDE_WORLD -29

/**
 * No room for the body: raise `palp_capacities.bodies`.
 */
#define PALP_FULL_BODIES -30

/**
 * No room for the piece: raise `palp_capacities.pieces`.
 */
#define PALP_FULL_PIECES -31

/**
 * No room for the piece's vertices: raise `palp_capacities.vertices`.
 */
#define PALP_FULL_VERTICES -32

/**
 * No room for the material: raise `palp_capacities.materials`.
 */
#define PALP_FULL_MATERIALS -33

/**
 * A velocity is not finite or too fast.
 */
#define PALP_BAD_VELOCITY -34

/**
 * Two bodies are needed, and both ids name the same one.
 */
#define PALP_SAME_BODY -35

/**
 * The id names no chain of this world.
 */
#define PALP_STALE_CHAIN -36

/**
 * No room for the chain: raise `palp_capacities.chains`.
 */
#define PALP_FULL_CHAINS -37

/**
 * No room for the chain's joints: raise `palp_capacities.joints`.
 */
#define PALP_FULL_JOINTS -38

/**
 * The body has `PALP_CHAINS_PER_BODY_MAX` chains.
 */
#define PALP_TOO_MANY_CHAINS -39

/**
 * A chain is to hang on what is no chain of the same body, or on a hinge that it does not have.
 */
#define PALP_BAD_BASE -40

/**
 * The axis of a hinge has no direction.
 */
#define PALP_BAD_AXIS -41

/**
 * A range of angles is not finite, reaches beyond a full turn, or ends below its start.
 */
#define PALP_BAD_RANGE -42

/**
 * A chain's options name no method or an unknown flag, its attraction is not 0 to 1e6 s, or its tip is
 * not finite.
 */
#define PALP_BAD_OPTIONS -43

/**
 * Another chain hangs on this one.
 */
#define PALP_CHAIN_IN_USE -44

/**
 * A reach cone has fewer than 3 corners.
 */
#define PALP_CONE_TOO_FEW_CORNERS -45

/**
 * A reach cone has more than `PALP_CONE_CORNERS_MAX` corners.
 */
#define PALP_CONE_TOO_MANY_CORNERS -46

/**
 * A corner of a reach cone, or the point that sees it, is zero or not finite.
 */
#define PALP_CONE_NO_DIRECTION -47

/**
 * Neighbouring corners of a reach cone are less than a milliradian apart, or less from opposite.
 */
#define PALP_CONE_BAD_EDGE -48

/**
 * The visible point of a reach cone does not see every edge from inside, by a milliradian at least.
 */
#define PALP_CONE_NOT_VISIBLE -49

/**
 * The corners of a reach cone go around its visible point more than once.
 */
#define PALP_CONE_BAD_WINDING -50

/**
 * A force, a torque or an impulse is not finite, or a coordinate of it or of its sum is beyond 1e9.
 */
#define PALP_BAD_FORCE -51

/**
 * A mass or a moment of inertia is outside 1e-9 to 1e9, the centre of mass is not finite or farther than
 * 1024 m from the body's origin, or the principal axes have no direction.
 */
#define PALP_BAD_MASS -52

/**
 * The bytes do not start as a log does.
 */
#define PALP_NOT_A_LOG -53

/**
 * The log has another format than this library reads.
 */
#define PALP_OTHER_LOG_VERSION -54

/**
 * The log ends in the middle of its head, of its state or of a call. A call of which only the outcome is
 * missing was made.
 */
#define PALP_LOG_CUT_SHORT -55

/**
 * The log has a call that this library does not know, or none where one is to be.
 */
#define PALP_UNKNOWN_CALL -56

/**
 * The arguments of a call in the log are not what such a call has.
 */
#define PALP_MALFORMED_CALL -57

/**
 * Called by the sink of the same world.
 */
#define PALP_INSIDE_SINK -58

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * What a status means, in English. Never null; lasts as long as the library is loaded.
 */
const char *palp_status_text(palp_status status);

/**
 * The library's version, such as "0.1.0". Never null; lasts as long as the library is loaded.
 */
const char *palp_version(void);

/**
 * Room for an avatar or two hands with fingers, a furnished room and a few loose objects: what
 * `PALP_CAPACITIES_ROOM` is at compile time. `capacities->struct_size` is set by the host.
 */
palp_status palp_capacities_room(struct palp_capacities *capacities);

/**
 * Bytes of the block that a world with these capacities needs. 0 when they are refused: null, a
 * wrong `struct_size`, or a capacity beyond what any world may have.
 */
size_t palp_memory_bytes(const struct palp_capacities *capacities);

/**
 * Makes an empty world in `memory`, which holds `bytes` bytes, aligned to `PALP_BLOCK_ALIGNMENT`.
 * What they held before does not matter. The memory stays the host's: it must outlive the last call
 * with the handle, and is freed when the world is no longer wanted.
 *
 * Call it as `palp_world_create`: the number in the symbol is `PALP_ABI`, so that a program built
 * with another header does not link.
 */
palp_status palp_world_create_abi2(void *memory,
                                   size_t bytes,
                                   const struct palp_capacities *capacities,
                                   struct palp_world **world);

/**
 * Takes up a world that was made in `memory`, or copied there, checking that `bytes` bytes hold it. Ends a
 * recording: whoever copies a block back to where it was is to call this.
 */
palp_status palp_world_attach(void *memory,
                              size_t bytes,
                              struct palp_world **world);

/**
 * The most that was ever in use at once: what to ship as capacities.
 * `capacities->struct_size` is set by the host.
 */
palp_status palp_high_water(const struct palp_world *world, struct palp_capacities *capacities);

/**
 * Sets the acceleration of loose bodies, in m/s2. A new world has 0, -9.81, 0.
 */
palp_status palp_gravity_set(struct palp_world *world, const struct palp_vec3 *gravity_m_s2);

/**
 * Adds a material, without friction or restitution against any other.
 */
palp_status palp_material_add(struct palp_world *world, uint32_t *material);

/**
 * Sets how two materials meet, in either order: restitution is speed after an impact over speed
 * before, 0 to 1; friction is Coulomb's coefficient, 0 to 1e6.
 */
palp_status palp_surface_set(struct palp_world *world,
                             uint32_t material_a,
                             uint32_t material_b,
                             float restitution,
                             float friction);

/**
 * Adds a body without pieces.
 */
palp_status palp_body_add(struct palp_world *world,
                          const struct palp_body_def *def,
                          struct palp_body_id *body);

/**
 * Removes a body, its pieces and its chains. Costs one pass over all pieces' vertices for each of its
 * pieces.
 */
palp_status palp_body_remove(struct palp_world *world,
                             struct palp_body_id body);

/**
 * Puts a body elsewhere at once, without a way there. A driven body forgets its displacement, a
 * dynamic one keeps its velocity. Overlap made so is reported by the next frame and never gets
 * deeper.
 */
palp_status palp_body_place(struct palp_world *world,
                            struct palp_body_id body,
                            const struct palp_pose *pose);

/**
 * Sets the velocity of a dynamic body's centre of mass in m/s and its angular velocity in rad/s,
 * both in the world, and wakes it.
 */
palp_status palp_body_set_velocity(struct palp_world *world,
                                   struct palp_body_id body,
                                   const struct palp_vec3 *linear_m_s,
                                   const struct palp_vec3 *angular_rad_s);

/**
 * The velocity of a dynamic body's centre of mass in m/s and its angular velocity in rad/s, both in
 * the world. Either pointer may be null.
 */
palp_status palp_body_velocity(const struct palp_world *world,
                               struct palp_body_id body,
                               struct palp_vec3 *linear_m_s,
                               struct palp_vec3 *angular_rad_s);

/**
 * The mass of a dynamic body in kg.
 */
palp_status palp_body_mass(const struct palp_world *world,
                           struct palp_body_id body,
                           float *mass_kg);

/**
 * Adds a force in newtons and a torque about the centre of mass in newton metres, both in the world, that
 * act on a dynamic body over the whole of the next frame, and wakes it. Each coordinate of a frame's sum is
 * at most 1e9.
 */
palp_status palp_body_apply_force(struct palp_world *world,
                                  struct palp_body_id body,
                                  const struct palp_vec3 *force_n,
                                  const struct palp_vec3 *torque_n_m);

/**
 * Changes a dynamic body's motion at once by an impulse in newton seconds at a point, both in the world,
 * and wakes it. The next frame slows what became faster than 1000 m/s or 3000 rad/s.
 */
palp_status palp_body_apply_impulse(struct palp_world *world,
                                    struct palp_body_id body,
                                    const struct palp_vec3 *impulse_n_s,
                                    const struct palp_vec3 *point);

/**
 * Whether a dynamic body sleeps, 1 or 0: it and all that it leans on have been still for a while.
 */
palp_status palp_body_is_asleep(const struct palp_world *world,
                                struct palp_body_id body,
                                uint32_t *asleep);

/**
 * Tells where a driven body's tracker is. Call it every frame: a frame without it, or with one that
 * is refused, counts the tracker as lost and keeps the last target.
 */
palp_status palp_body_set_target(struct palp_world *world,
                                 struct palp_body_id body,
                                 const struct palp_pose *target);

/**
 * Tells where a driven body's pieces are to be in its frame, in the order they were added: the
 * fingers of a tracked hand. A piece on a link of a chain is to be there in the link's frame. They move there over the frame, as far as contact allows. Refused as a
 * whole when `count` is not the number of pieces or any pose is bad.
 */
palp_status palp_body_set_piece_targets(struct palp_world *world,
                                        struct palp_body_id body,
                                        const struct palp_pose *poses,
                                        uint32_t count);

/**
 * The published pose of a body.
 */
palp_status palp_body_pose(const struct palp_world *world,
                           struct palp_body_id body,
                           struct palp_pose *pose);

/**
 * What the last frame did to a driven body. `state->struct_size` is set by the host.
 */
palp_status palp_driven_report(const struct palp_world *world,
                               struct palp_body_id body,
                               struct palp_driven_state *state);

/**
 * Tells where the host's own bodies are, how they move and what they weigh; call it once before each frame
 * with all that move. Driven bodies make room for them, push, squeeze and hold them, as if gravity and
 * contacts alone moved them in the frame; `palp_hosted_impulses` gives what that did to them.
 *
 * `inputs` are `count` structs, `stride` bytes from one to the next, so that they may lie in larger structs
 * of the host's; a stride of 0 is refused. Every entry that is good is taken, the others stay as they were:
 * then the status is `PALP_ENTRIES_REFUSED`, and `refusal`, which may be null, names the first of them and
 * says why. Costs a pass over the pieces of the bodies that moved.
 */
palp_status palp_hosted_set(struct palp_world *world,
                            const struct palp_hosted_input *inputs,
                            uint32_t count,
                            uint32_t stride,
                            struct palp_refusal *refusal);

/**
 * What driven and dynamic bodies did to a hosted body in the last frame. The host's engine is to apply it
 * before its own step. `state->struct_size` is set by the host.
 */
palp_status palp_hosted_impulse(const struct palp_world *world,
                                struct palp_body_id body,
                                struct palp_hosted_state *state);

/**
 * As `palp_hosted_impulse`, for many bodies at once: `bodies` are `count` ids, `body_stride` bytes from one
 * to the next, and `states` as many results, `state_stride` bytes apart, so that both may lie in larger
 * structs of the host's; a stride of 0 is refused. The `struct_size` of each state is set by the host.
 * Every entry that is good is answered, the others stay as they were: then the status is
 * `PALP_ENTRIES_REFUSED`, and `refusal`, which may be null, names the first of them and says why.
 */
palp_status palp_hosted_impulses(const struct palp_world *world,
                                 const struct palp_body_id *bodies,
                                 uint32_t body_stride,
                                 struct palp_hosted_state *states,
                                 uint32_t state_stride,
                                 uint32_t count,
                                 struct palp_refusal *refusal);

/**
 * Adds a piece to a body, behind those it has. Builds its hull on the stack.
 */
palp_status palp_piece_add(struct palp_world *world,
                           struct palp_body_id body,
                           const struct palp_piece_def *def,
                           struct palp_piece_id *piece);

/**
 * Removes a piece. Costs one pass over all pieces' vertices.
 */
palp_status palp_piece_remove(struct palp_world *world, struct palp_piece_id piece);

/**
 * Says which driven pieces pass through each other: of pieces of two driven bodies, or of two chains of
 * one, those pass of which one belongs to a group, a bit of `member_of`, that the other passes through,
 * a bit of `passes`. Fixed and dynamic bodies stop every piece. A new piece has zero for both.
 */
palp_status palp_piece_set_groups(struct palp_world *world,
                                  struct palp_piece_id piece,
                                  uint32_t member_of,
                                  uint32_t passes);

/**
 * The published pose of a piece in the world.
 */
palp_status palp_piece_pose(const struct palp_world *world,
                            struct palp_piece_id piece,
                            struct palp_pose *pose);

/**
 * The published poses of all piece slots in the world: entry `index1 - 1` is that of a piece's id;
 * slots not in use hold anything. The array lies in the world's block and is good until the next call
 * that changes the world. `count` may be null.
 */
palp_status palp_piece_poses(const struct palp_world *world,
                             const struct palp_pose **poses,
                             uint32_t *count);

/**
 * Adds a chain of joints to a driven body, behind those it has: an arm, a leg, a finger. Its angles
 * begin at zero, or where the limits are nearest to it, and are held there until targets come.
 */
palp_status palp_chain_add(struct palp_world *world,
                           struct palp_body_id body,
                           const struct palp_chain_def *def,
                           struct palp_chain_id *chain);

/**
 * Removes a chain and the pieces on its links. Refused while another chain hangs on it. Costs one pass
 * over all pieces' vertices for each of its pieces, and one over all joints.
 */
palp_status palp_chain_remove(struct palp_world *world,
                              struct palp_chain_id chain);

/**
 * Says how a chain answers contact from the next frame on.
 */
palp_status palp_chain_set_options(struct palp_world *world,
                                   struct palp_chain_id chain,
                                   const struct palp_chain_options *options);

/**
 * Adds a piece to the link behind a hinge of a chain, `hinge` counting from 0, three to a ball. The
 * piece's `local_pose` is in that link's frame. Counts as the body's last piece.
 */
palp_status palp_chain_add_piece(struct palp_world *world,
                                 struct palp_chain_id chain,
                                 uint32_t hinge,
                                 const struct palp_piece_def *def,
                                 struct palp_piece_id *piece);

/**
 * Tells where the tracker wants a chain's hinges, in radians, from the base on, three to a ball. What is
 * outside a range or a reach cone becomes the nearest that is inside. The chain moves there over the
 * frame, as far as contact allows, and keeps its targets until others come. Refused as a whole when
 * `count` is not the number of hinges or an angle is not finite.
 */
palp_status palp_chain_set_angles(struct palp_world *world,
                                  struct palp_chain_id chain,
                                  const float *angles_rad,
                                  uint32_t count);

/**
 * Tells where the tracker sees a chain's links: one pose in the world for each joint of its definition,
 * a ball being one joint, that of the link behind it. Only the orientations count; what the joints
 * cannot do is left out. Instead of `palp_chain_set_angles`; call it behind `palp_body_set_target`, and
 * for a chain behind the one that it hangs on.
 */
palp_status palp_chain_set_link_poses(struct palp_world *world,
                                      struct palp_chain_id chain,
                                      const struct palp_pose *poses,
                                      uint32_t count);

/**
 * Tells where the tracker sees the last link alone, in the world: a controller in the hand. The targets
 * become the angles that bring the link there with the least change from `posture_rad`, one angle for
 * each hinge, or that come as near as the limits allow. Give a relaxed posture, the same in every frame:
 * then nothing drifts. `distance_m`, which may be null, gets how far from there the link's origin is
 * then, in metres.
 * Instead of `palp_chain_set_angles`; call it behind `palp_body_set_target`, and for a chain behind the
 * one that it hangs on. Costs at most 16 steps of the least-deviation solver.
 */
palp_status palp_chain_set_tip(struct palp_world *world,
                               struct palp_chain_id chain,
                               const struct palp_pose *tip,
                               const float *posture_rad,
                               uint32_t count,
                               float *distance_m);

/**
 * Puts a chain's hinges at angles at once, without a way there; they become the targets too. What is
 * outside the limits becomes the nearest that is inside. Overlap made so is reported by the next frame
 * and never gets deeper.
 */
palp_status palp_chain_place(struct palp_world *world,
                             struct palp_chain_id chain,
                             const float *angles_rad,
                             uint32_t count);

/**
 * The published angles of a chain's hinges in radians, from the base on. The array lies in the world's
 * block and is good until the next call that changes the world. `count` may be null.
 */
palp_status palp_chain_angles(const struct palp_world *world,
                              struct palp_chain_id chain,
                              const float **angles_rad,
                              uint32_t *count);

/**
 * The target angles of a chain's hinges in radians, as the limits left them. The array lies in the
 * world's block and is good until the next call that changes the world. `count` may be null.
 */
palp_status palp_chain_target_angles(const struct palp_world *world,
                                     struct palp_chain_id chain,
                                     const float **angles_rad,
                                     uint32_t *count);

/**
 * The published poses of a chain's links in the world, one behind each hinge. The array lies in the
 * world's block and is good until the next call that changes the world. `count` may be null.
 */
palp_status palp_chain_link_poses(const struct palp_world *world,
                                  struct palp_chain_id chain,
                                  const struct palp_pose **poses,
                                  uint32_t *count);

/**
 * What the last frame did to a chain. `state->struct_size` is set by the host.
 */
palp_status palp_chain_report(const struct palp_world *world,
                              struct palp_chain_id chain,
                              struct palp_chain_state *state);

/**
 * Whether directions make a reach cone: PALP_OK, or the `PALP_CONE_` status with which `palp_chain_add`
 * would refuse a ball with it. For tools that author skeletons; needs no world.
 */
palp_status palp_cone_check(const struct palp_vec3 *visible,
                            const struct palp_vec3 *corners,
                            uint32_t count);

/**
 * Joints, ranges and reach cones of a human limb for a body of a height from 0.3 to 3 m; ranges after the
 * American Academy of Orthopaedic Surgeons, lengths after Drillis and Contini 1966. The root is midway
 * between the hip joints, the body stands upright at zero angles, faces -Z, its right side is +X, its
 * arms hang. `on_root` other than zero: arms and neck hang on the root, which has the trunk; else on the
 * spine's last link. `joints` has room for `PALP_LIMB_JOINTS_MAX`; `count` gets their number. `tip` gets
 * the limb's end in the last link's frame, in metres, and may be null.
 */
palp_status palp_human_limb(uint32_t which,
                            uint32_t on_root,
                            float height_m,
                            struct palp_joint *joints,
                            uint32_t *count,
                            struct palp_vec3 *tip);

/**
 * Hinges of a finger whose bones a tracker gave at rest: `bones` are three poses of joints in the frame
 * that the chain is to hang on, with OpenXR's axes (-Z along the bone, +Y to the back of the hand): of a
 * finger its knuckle, middle and last joint, of the thumb its metacarpal, knuckle and last joint. `tip`
 * is the finger's end in that frame, in metres. Zero angles are the rest pose. `joints` has room for
 * `PALP_LIMB_JOINTS_MAX`; `count` gets their number.
 */
palp_status palp_human_finger(uint32_t which,
                              const struct palp_pose *bones,
                              const struct palp_vec3 *tip,
                              struct palp_joint *joints,
                              uint32_t *count);

/**
 * Tells where a hand tracker sees the 26 joints of a hand that is a driven body: the wrist becomes the
 * body's target, and each piece's target in the body's frame is its joint seen from the wrist, then
 * its offset. For hands without chains: a piece on a link would take that for its pose in the link's
 * frame. Instead of `palp_body_set_target` and `palp_body_set_piece_targets`; call it every frame
 * in which `XrHandJointLocationsEXT.isActive` is true.
 *
 * `locations` is an `XrHandJointLocationEXT[26]` as `xrLocateHandJointsEXT` filled it, of any
 * alignment, `stride` bytes from one joint to the next; 0 stands for 40. `piece_joints` has the number
 * of the joint that carries each piece, in the order the pieces were added, 0 to 25, and
 * `piece_offsets` each piece's pose on that joint; null when all pieces lie on their joints as they
 * are. `count` is the number of pieces. A joint farther than `reach_m` metres from the wrist is not
 * believed; 0.5 suits a hand of human size.
 *
 * Flags are checked and not trusted. A joint whose orientation or position is not flagged as valid,
 * not finite, without length or out of reach is ignored: its pieces keep their last targets, and the
 * status is `PALP_JOINTS_IGNORED`. When the wrist is like that, nothing is set, the next frame counts
 * the tracker as lost, and the status is `PALP_TRACKING_LOST`. `pieces_kept`, which may be null, gets
 * the number of pieces that keep their last targets.
 */
palp_status palp_hand_set_joints(struct palp_world *world,
                                 struct palp_body_id body,
                                 const void *locations,
                                 uint32_t stride,
                                 const struct palp_pose *piece_offsets,
                                 const uint32_t *piece_joints,
                                 uint32_t count,
                                 float reach_m,
                                 uint32_t *pieces_kept);

/**
 * Steps the world by one frame, spending at most the input's units. Several things may have been cut;
 * the status is the gravest of them (overlap, pairs, contacts, advance, reach, impulses, time, time step, flushing),
 * the report has them all. `report->struct_size` is set by the host; `report` may be null.
 */
palp_status palp_frame_step(struct palp_world *world,
                            const struct palp_frame_input *input,
                            struct palp_frame_report *report);

/**
 * Like `palp_frame_step`, with a clock as a backstop: no units are begun that would not be over before
 * `ends_ns` by it and by the prices of the input's costs; without prices they take no time. Closing the frame
 * comes after that: `ends_ns` is best set by `palp_frame_floor` before the frame is to be over, and by
 * what an interrupt takes. Where the clock cuts, the report says `PALP_FRAME_LATE`, and stepping with the report's
 * units and no deadline gives the same bits.
 */
palp_status palp_frame_step_by_clock(struct palp_world *world,
                                     const struct palp_frame_input *input,
                                     struct palp_frame_report *report,
                                     palp_clock clock,
                                     void *user,
                                     uint64_t ends_ns);

/**
 * What the next frame costs whatever happens, by `costs`, in nanoseconds.
 */
palp_status palp_frame_floor(const struct palp_world *world,
                             const struct palp_costs *costs,
                             uint64_t *floor_ns);

/**
 * The contacts of the last frame. The array lies in the world's block and is good until the next call
 * that changes the world.
 */
palp_status palp_contacts(const struct palp_world *world,
                          const struct palp_contact **contacts,
                          uint32_t *count);

/**
 * What began to touch, stayed and parted in the last frame: one event for each pair of pieces, first those
 * that began, then those that ended, then those that stayed. Bodies that sleep go on touching without being
 * told of. The array lies in the world's block and is good until the next call that changes the world. What
 * found no room, those that stayed before all others, is counted in `palp_frame_report.events_dropped`.
 */
palp_status palp_contact_events(const struct palp_world *world,
                                const struct palp_contact_event **events,
                                uint32_t *count);

/**
 * How deep two bodies overlap where they are published, and the least translation of A that parts
 * them; or how far apart they are, and the closest points. Needs no frame, changes nothing, and is
 * refused when `a` is `b`. `result->struct_size` is set by the host.
 *
 * Takes about 200 kB of stack. Pairs of pieces far from each other cost a look at their boxes.
 * `PALP_PAIRS_LEFT_OUT`: more than 64 pairs of pieces are in the way of the translation, or it took
 * more rounds than 8 to find them; the depth may then be too small to part the bodies.
 */
palp_status palp_penetration(const struct palp_world *world,
                             struct palp_body_id a,
                             struct palp_body_id b,
                             struct palp_penetration_result *result);

/**
 * As `palp_penetration`, with the bodies at other poses. Their pieces keep the local poses that were
 * published: a bent finger stays bent.
 */
palp_status palp_penetration_at(const struct palp_world *world,
                                struct palp_body_id a,
                                const struct palp_pose *pose_a,
                                struct palp_body_id b,
                                const struct palp_pose *pose_b,
                                struct palp_penetration_result *result);

/**
 * Bytes that `palp_state_save` writes: depends on the capacities alone.
 */
palp_status palp_state_bytes(const struct palp_world *world, size_t *bytes);

/**
 * Copies the state into a buffer of `bytes` bytes of any alignment, at least as many as
 * `palp_state_bytes` says, which is how many are written. `written` may be null.
 */
palp_status palp_state_save(const struct palp_world *world,
                            void *buffer,
                            size_t bytes,
                            size_t *written);

/**
 * Rolls the world back to a state saved from it, or from one with the same capacities. Ids of that
 * time are good again. Its head is checked and the rest is not: load only what `palp_state_save`
 * wrote.
 */
palp_status palp_state_load(struct palp_world *world, const void *buffer, size_t bytes);

/**
 * A hash of the whole state: equal after equal calls, on every processor. Not a checksum against
 * forgery.
 */
palp_status palp_state_hash(const struct palp_world *world, uint64_t *hash);

/**
 * Begins a log: hands `sink` the state as it is, and from now on every call that changes the world, before
 * and after it is made. `user` goes to the sink as it is. Both are kept until `palp_recording_stop` or
 * `palp_world_attach`; a recording that goes on is ended. A call that is refused before it reaches the world,
 * for a null pointer or a wrong size, is not in the log.
 *
 * Costs a hash of the state a frame, of as many bytes as `palp_state_bytes` says.
 */
palp_status palp_recording_start(struct palp_world *world,
                                 palp_sink sink,
                                 void *user);

/**
 * Ends a recording. The log is whole as it is. Fine without a recording.
 */
palp_status palp_recording_stop(struct palp_world *world);

/**
 * Judges the head of a log of `size` bytes, of any alignment, which is to stay where it is until it is
 * replayed. `replay->struct_size` is set by the host.
 */
palp_status palp_replay_open(const void *log,
                             size_t size,
                             struct palp_replay *replay);

/**
 * The capacities of the world that was recorded, for `palp_memory_bytes`. `capacities->struct_size` is set
 * by the host.
 */
palp_status palp_replay_capacities(const struct palp_replay *replay,
                                   struct palp_capacities *capacities);

/**
 * Makes the world as it was when the recording began, in `memory` as for `palp_world_create`, and goes to the
 * first call.
 */
palp_status palp_replay_start(struct palp_replay *replay,
                              void *memory,
                              size_t bytes,
                              struct palp_world **world);

/**
 * Makes the next call of the log on the world that `palp_replay_start` made. `PALP_OK` when it came to what
 * it came to when it was recorded, `PALP_REPLAY_DIFFERS` when not, `PALP_REPLAY_END` when there is none.
 * `call`, which may be null, says which call it was; nothing is written there at the end. `replay` says how
 * far it has come, whatever the status. The replay may go on behind a call that differs.
 *
 * No bytes of a log break the world; a state that was forged with its checksum may.
 */
palp_status palp_replay_next(struct palp_replay *replay,
                             struct palp_world *world,
                             struct palp_replayed *call);

/**
 * The name of a call in a log, as the kernel in Rust has it. Never null; lasts as long as the library is
 * loaded.
 */
const char *palp_call_name(uint32_t kind);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PALPABLE_H */
