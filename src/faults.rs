//! What happens on bad input: each gets a named error or a documented clamp, and the last good state stays.
//!
//! Where "nothing" changes, the hash of the world is the same to the bit. Each row names the test that holds
//! it; beside them random hosts do all of it in any order, every frame judged in f64
//! (`cargo run --release -p palpable-lab -- simulate`).
//!
//! | input | what comes back | what changes | test |
//! |---|---|---|---|
//! | a pose that is not finite, beyond the world's reach, or with a quaternion without length | `BadPose` | nothing | `impossible_poses_are_refused_by_name_and_change_nothing` |
//! | a quaternion of another sound length, or of the other sign | fine | it is normalised | `orientations_of_any_sound_length_are_normalised` |
//! | denormal numbers | fine | they count as they are | `denormal_numbers_are_numbers` |
//! | a bad tracker pose | `BadPose` | nothing; the frame counts the tracker as lost | `a_bad_target_counts_as_a_lost_tracker` |
//! | no tracker pose | the frame's `LOST`, after the grace | the last target stays | `a_lost_tracker_keeps_its_target_and_is_reported_after_the_grace` |
//! | a tracker that was never seen | fine | the body stays | `a_body_whose_tracker_was_never_seen_stays` |
//! | one bad piece target of several | `BadPose` | nothing | `one_bad_piece_target_keeps_all_the_old_ones` |
//! | hand joints: a bad root | `root: false` | nothing | `joints_of_a_hand_that_are_not_good_keep_what_was_there` |
//! | hand joints: another one that is bad, missing or out of reach | `pieces_kept` | its pieces keep their targets | `joints_of_a_hand_that_are_not_good_keep_what_was_there` |
//! | joint angles or link poses that are not finite, too few or too many | `BadAngle`, `BadPose`, `WrongCount` | nothing | `bad_targets_of_chains_keep_the_old_ones` |
//! | joint angles outside their ranges or cones | fine | the nearest allowed ones count | `bad_targets_of_chains_keep_the_old_ones` |
//! | a chain of no joint or too many, of bad rests, axes, ranges, bases or options | `AddChainError` | nothing | `joints_that_make_no_chain_are_refused_by_name` |
//! | a time step of zero, below zero, infinite or not a number | `BAD_TIME_STEP` | nothing | `a_time_step_that_is_none_moves_nothing` |
//! | a time step too short or too long | `TIME_STEP_CLAMPED` | the frame is as long as the bound | `a_time_step_too_short_or_too_long_is_clamped` |
//! | a null, stale or made-up id | `Stale`, `StaleBody`, `StaleChain` | nothing | `null_and_stale_ids_are_refused_and_change_nothing` |
//! | a body of another kind, a count that does not fit | `WrongKind`, `WrongCount` | nothing | `the_wrong_kind_and_the_wrong_count_are_named` |
//! | velocities, surfaces or springs out of bounds | `BadVelocity`, `BadSurface`, `BadCoupling` | nothing | `bad_numbers_of_velocities_surfaces_and_couplings_are_refused` |
//! | friction that f32 cannot multiply | `BadSurface` | nothing | `friction_beyond_what_f32_can_multiply_is_refused` |
//! | forces, impulses, hosted poses, masses or moments out of bounds | `BadForce`, `BadPose`, `BadMass` | nothing; the other hosted bodies are taken | `bad_input_is_refused_and_changes_nothing` |
//! | gravity that is not finite or too strong | no error | nothing | `gravity_that_is_none_is_left_out` |
//! | a piece without extent | `Degenerate` | nothing | `shapes_without_extent_are_degenerate` |
//! | a piece with numbers that are none, or too large | `NotFinite`, `TooLarge` | nothing | `numbers_that_are_none_are_not_finite` |
//! | a piece of bad radius, density, material or pose | `BadNumber`, `UnknownMaterial`, `BadPose` | nothing | `bad_radius_density_material_and_pose_are_named` |
//! | one body, piece, vertex or material more than there is room for | `Full`, `FullPieces`, `FullVertices` | nothing | `every_pool_full_by_one_is_refused_and_nothing_changes` |
//! | one chain or joint more than there is room for | `FullChains`, `FullJoints` | nothing | `chains_and_joints_full_by_one_are_refused_and_nothing_changes` |
//! | one pair more than there is room for | `FULL_PAIRS` | its mover stays | `pairs_full_by_one_hold_their_mover_and_are_reported` |
//! | one contact more than there is room for | `FULL_CONTACTS` | it is left out | `contacts_full_by_one_are_reported` |
//! | a budget of nothing | `ADVANCE_CUT`, `IMPULSES_CUT`, `REACH_CUT` | what is not proved clear by boxes stays | `without_budget_the_arm_is_held_before_the_wall_within_its_limits` |
//! | a driven body placed, or made, inside fixed ones | `OVERLAP` | it leaves, if there is a way; it comes no deeper | `a_body_spawned_in_the_floor_and_a_wall_gets_out_of_both` |
//! | the same before a frame that may not look | `ADVANCE_CUT`, then `OVERLAP` | the next frame looks | `overlap_is_told_of_after_a_frame_that_could_not_look` |
//! | a loose body that leaves the world | no error | it stops there, sleeps, and is in the way | `what_left_the_world_is_still_in_the_way_of_a_hand` |
//! | speeds, gravity or densities beyond all use | an error, or slowed to the bound | everything stays finite | `no_speed_gravity_or_density_makes_a_frame_endless_or_a_pose_not_finite` |
//! | an impulse that would make a body faster than any scene needs | fine | it becomes as fast as the bound | `an_impulse_makes_nothing_faster_than_the_limits` |
//! | a piece taken from a body that moves | fine | what is left moves on as it did | `what_is_left_of_a_body_moves_as_it_did` |
//! | a block that is misaligned, short or garbage | `Misaligned`, `TooSmall`, `NotAWorld` | nothing | `garbage_and_truncated_blocks_are_refused` |
//! | a block whose head was written to | `NotAWorld`, `OtherLayout`, `Damaged` | nothing | `every_flipped_bit_of_the_header_is_refused` |
//! | capacities beyond their bounds | `CapacityTooLarge` | nothing | `a_capacity_above_its_bound_is_refused` |
//! | a snapshot that is short, foreign or damaged | `TooSmall`, `OtherLayout`, `Damaged` | nothing | `a_bad_snapshot_is_refused_and_nothing_changes` |
//! | a snapshot or a block's head damaged anyhow | as above | nothing | `damaged_snapshots_and_blocks_are_refused` |
//!
//! Not promised: the checksums find accidents and are no signatures, so a forged snapshot is taken; and a block
//! has a checksum over its head alone, so what is written behind it is believed.
