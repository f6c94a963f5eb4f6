/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,
/// with each narrow phase and each scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::spin, collide::velocity_verlet, collide::sphere_contact, collide::friction, collide::gravity, collide::reaction, collide::moving_bodies<>>;
using list_2 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::gravity, collide::sphere_contact, collide::bounce, collide::adhesion, collide::reaction, collide::pair_forces, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::bounce, collide::gravity, collide::sleep, collide::friction, collide::sphere_contact, collide::polydisperse, collide::spin, collide::reaction, collide::moving_bodies<>>;
using list_4 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::velocity_verlet, collide::gravity, collide::lost, collide::bounce, collide::adhesion, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_5 = scene_list<mesh_kind::fixed, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::gravity, collide::sphere_contact, collide::bounce, collide::velocity_verlet, collide::reaction>;
using list_6 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::bounce, collide::spin, collide::adhesion, collide::friction, collide::mesh_forces, collide::gravity, collide::sleep, collide::reaction>;
using list_7 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::gravity, collide::sphere_contact, collide::velocity_verlet, collide::sleep, collide::bounce, collide::friction, collide::adhesion, collide::spin, collide::reaction, collide::moving_bodies<>>;
using list_8 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::gravity, collide::sleep, collide::granular_contact<collide::linear, collide::dashpot>, collide::mesh_forces, collide::reaction, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_9 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::lost, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::velocity_verlet, collide::gravity, collide::pair_forces, collide::reaction, collide::polydisperse, collide::moving_bodies<>>;
using list_10 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::sphere_contact, collide::sleep, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mesh_forces, collide::lost, collide::absorbing_box, collide::lost_motion, collide::emit, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_11 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::emit, tests::pairs::warms, collide::wind<>, collide::box_walls, collide::absorb, collide::periodic_box, collide::mass_flow<>, collide::velocity_verlet, collide::pair_forces, collide::lost_motion, tests::pairs::stirs, collide::moving_bodies<collide::driven>>;
using list_12 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::drag, collide::mass_flow<>, tests::pairs::stirs, collide::absorb, collide::box_walls, collide::bounce, tests::pairs::warms, collide::adhesion, collide::absorbing_box, collide::mesh_forces, collide::periodic_box, collide::polydisperse, collide::moving_bodies<>>;
using list_13 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::wind<>, collide::lost, collide::absorb, collide::bounce, collide::friction, collide::gravity, collide::absorbing_box, collide::spin, collide::periodic_box, collide::box_walls, collide::drag, collide::sleep, collide::moving_bodies<collide::driven>>;
using list_14 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::mass_flow<>, collide::wind<>, collide::periodic_box, collide::drag, collide::sphere_contact, collide::box_walls, tests::pairs::stirs, collide::sleep, collide::lost, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::reaction, collide::pair_forces, collide::moving_bodies<>>;
using list_15 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost_motion, tests::pairs::warms, tests::pairs::stirs, collide::polydisperse, collide::mass_flow<>, collide::bounce, collide::emit, collide::gravity, collide::spin, collide::adhesion, collide::friction, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_16 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::emit, collide::lost, collide::mesh_forces, collide::sphere_contact, collide::absorb, tests::pairs::warms, collide::wind<>, collide::reaction, collide::sleep, collide::pair_forces, collide::lost_motion, collide::absorbing_box, collide::moving_bodies<>>;
using list_17 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mass_flow<>, collide::emit, tests::pairs::stirs, collide::polydisperse, collide::wind<>, collide::periodic_box, collide::gravity, collide::velocity_verlet, collide::lost_motion, collide::box_walls, collide::drag, collide::moving_bodies<>>;
using list_18 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::lost_motion, collide::velocity_verlet, collide::lost, collide::emit, tests::pairs::warms, collide::pair_forces, collide::wind<>, collide::absorb, collide::bounce, collide::adhesion, collide::spin, collide::friction, collide::moving_bodies<>>;
using list_19 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    tests::pairs::stirs, collide::drag, collide::polydisperse, collide::velocity_verlet, collide::reaction, collide::periodic_box, collide::lost, collide::mass_flow<>, collide::absorbing_box, collide::sphere_contact, collide::pair_forces, collide::sleep, collide::moving_bodies<collide::driven>>;
using list_20 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::bounce, collide::friction, collide::box_walls, collide::adhesion, collide::wind<>, collide::absorb, collide::spin, collide::pair_forces, collide::mesh_forces, collide::reaction, collide::polydisperse, collide::moving_bodies<collide::driven>>;
using list_21 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    tests::pairs::stirs, collide::mass_flow<>, collide::gravity, collide::periodic_box, tests::pairs::warms, collide::absorbing_box, collide::drag, collide::velocity_verlet, collide::bounce, collide::spin, collide::friction, collide::mesh_forces, collide::moving_bodies<>>;
using list_22 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::absorbing_box, collide::mass_flow<>, collide::box_walls, collide::sphere_contact, tests::pairs::stirs, collide::periodic_box, collide::wind<>, collide::polydisperse, collide::drag, collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::pair_forces, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_23 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::lost, collide::sleep, collide::bounce, collide::emit, collide::lost_motion, collide::adhesion, collide::spin, tests::pairs::warms, collide::friction, collide::absorb, collide::pair_forces, collide::absorbing_box, collide::moving_bodies<collide::driven>>;
using list_24 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::box_walls, collide::mass_flow<>, collide::velocity_verlet, collide::periodic_box, collide::drag, tests::pairs::stirs, collide::gravity, collide::bounce, collide::absorbing_box, collide::friction, collide::spin, collide::adhesion, collide::moving_bodies<collide::driven>>;
using list_25 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::sphere_contact, collide::sleep, collide::polydisperse, collide::reaction, collide::wind<>, collide::gravity, collide::absorb, tests::pairs::warms, collide::velocity_verlet, collide::absorbing_box, collide::moving_bodies<collide::driven>>;
using list_26 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::granular_contact<collide::linear, collide::dashpot>, collide::emit, collide::mesh_forces, collide::lost_motion, collide::absorbing_box, collide::lost, collide::moving_bodies<>>;
using list_27 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::box_walls, collide::bounce, collide::friction, collide::spin, collide::reaction, collide::moving_bodies<>>;
using list_28 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::gravity, collide::absorb, collide::pair_forces, collide::polydisperse, collide::moving_bodies<>>;
using list_29 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::adhesion, collide::periodic_box, collide::drag, collide::moving_bodies<>>;
using list_30 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::wear<>, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::polydisperse, collide::lost, collide::moving_bodies<>>;
using list_31 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::clumps, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::pair_forces, collide::lost, collide::periodic_box, collide::moving_bodies<>>;
using list_32 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::velocity_verlet, collide::gravity, collide::wind<>, tests::pairs::stirs, collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::wear<>, collide::clumps, collide::mass_flow<>, collide::absorbing_box, collide::polydisperse, collide::lost_motion, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_33 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::sleep, collide::gravity, collide::emit, collide::granular_contact<collide::linear, collide::dashpot>, collide::wear<>, collide::contact_work<>, collide::lost, collide::reaction, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_34 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::gravity, collide::sphere_contact, collide::contact_work<>, collide::polydisperse, collide::periodic_box, collide::lost>;
using list_35 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::wear<>, collide::sleep, collide::clumps, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::polydisperse, collide::lost, collide::moving_bodies<collide::driven>>;
using list_36 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::sleep, collide::clumps, collide::pair_forces, tests::pairs::stirs, collide::contact_work<>, collide::mass_flow<>, collide::absorbing_box, collide::periodic_box, collide::moving_bodies<>>;
using list_37 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::sphere_contact, collide::gravity, collide::absorb, collide::clumps, collide::mass_flow<>, collide::sleep, collide::polydisperse, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
