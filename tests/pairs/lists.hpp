/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,
/// with each narrow phase and each scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::gravity, collide::velocity_verlet, collide::reaction, collide::sphere_contact, collide::spin, collide::bounce, collide::friction, collide::moving_bodies<>>;
using list_2 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::reaction, collide::mesh_forces, collide::sphere_contact, collide::bounce, collide::adhesion, collide::pair_forces, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::reaction, collide::spin, collide::gravity, collide::polydisperse, collide::sphere_contact, collide::bounce, collide::sleep, collide::friction, collide::moving_bodies<>>;
using list_4 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::bounce, collide::gravity, collide::adhesion, collide::reaction, collide::lost, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_5 = scene_list<mesh_kind::fixed, collide::karabassi_swept<>, double,
    collide::reaction, collide::velocity_verlet, collide::sphere_contact, collide::polydisperse, collide::gravity, collide::bounce>;
using list_6 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::spin, collide::sleep, collide::reaction, collide::bounce, collide::gravity, collide::adhesion, collide::friction, collide::mesh_forces>;
using list_7 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::sleep, collide::gravity, collide::sphere_contact, collide::velocity_verlet, collide::spin, collide::reaction, collide::bounce, collide::friction, collide::adhesion, collide::moving_bodies<>>;
using list_8 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::sleep, collide::velocity_verlet, collide::reaction, collide::mesh_forces, collide::granular_contact<collide::linear, collide::dashpot>, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_9 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::pair_forces, collide::lost, collide::reaction, collide::polydisperse, collide::gravity, collide::moving_bodies<>>;
using list_10 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::sphere_contact, collide::sleep, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mesh_forces, collide::lost, collide::absorbing_box, collide::lost_motion, collide::emit, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_11 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::emit, collide::wind<>, collide::absorbing_box, collide::mass_flow<>, collide::periodic_box, tests::pairs::stirs, collide::absorb, tests::pairs::warms, collide::pair_forces, collide::velocity_verlet, collide::box_walls, collide::moving_bodies<collide::driven>>;
using list_12 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::box_walls, collide::lost_motion, collide::mass_flow<>, collide::drag, collide::mesh_forces, tests::pairs::stirs, collide::absorb, collide::bounce, collide::periodic_box, collide::wind<>, collide::polydisperse, collide::adhesion, collide::moving_bodies<>>;
using list_13 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost, collide::lost_motion, collide::gravity, collide::spin, collide::sleep, collide::drag, collide::bounce, collide::friction, collide::box_walls, tests::pairs::warms, collide::mass_flow<>, collide::wind<>, collide::moving_bodies<collide::driven>>;
using list_14 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::emit, collide::periodic_box, tests::pairs::stirs, collide::lost, collide::absorb, collide::absorbing_box, collide::friction, collide::sleep, collide::pair_forces, collide::spin, collide::gravity, collide::moving_bodies<>>;
using list_15 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::reaction, collide::polydisperse, collide::absorb, collide::mesh_forces, collide::sphere_contact, collide::bounce, tests::pairs::stirs, collide::adhesion, collide::periodic_box, collide::lost_motion, tests::pairs::warms, collide::emit, collide::moving_bodies<collide::driven>>;
using list_16 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    tests::pairs::stirs, collide::sphere_contact, collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::lost, collide::box_walls, collide::emit, collide::mass_flow<>, collide::wind<>, collide::reaction, collide::absorbing_box, collide::drag, collide::velocity_verlet, collide::moving_bodies<>>;
using list_17 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::wind<>, collide::drag, collide::lost_motion, tests::pairs::warms, collide::bounce, collide::friction, collide::sleep, collide::gravity, collide::box_walls, collide::spin, collide::mass_flow<>, collide::pair_forces, collide::moving_bodies<>>;
using list_18 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::reaction, collide::box_walls, collide::polydisperse, collide::bounce, collide::adhesion, collide::mass_flow<>, collide::wind<>, collide::mesh_forces, collide::drag, collide::friction, collide::absorbing_box, collide::spin, collide::moving_bodies<collide::driven>>;
using list_19 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    tests::pairs::warms, collide::absorbing_box, collide::mesh_forces, collide::polydisperse, collide::lost, collide::bounce, collide::lost_motion, collide::emit, collide::adhesion, collide::velocity_verlet, collide::sphere_contact, collide::pair_forces, collide::moving_bodies<>>;
using list_20 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::periodic_box, collide::bounce, collide::pair_forces, tests::pairs::stirs, collide::spin, collide::friction, collide::emit, collide::gravity, collide::lost, collide::sleep, collide::absorbing_box, collide::absorb, collide::moving_bodies<collide::driven>>;
using list_21 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::emit, collide::mass_flow<>, collide::absorb, collide::drag, collide::wind<>, tests::pairs::warms, collide::periodic_box, collide::sphere_contact, tests::pairs::stirs, collide::velocity_verlet, collide::reaction, collide::absorbing_box, collide::moving_bodies<>>;
using list_22 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    tests::pairs::stirs, collide::velocity_verlet, collide::wind<>, collide::mass_flow<>, collide::drag, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::polydisperse, collide::sleep, collide::sphere_contact, collide::box_walls, collide::lost, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_23 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost, collide::sleep, collide::spin, collide::lost_motion, collide::reaction, collide::sphere_contact, collide::pair_forces, collide::velocity_verlet, collide::bounce, collide::friction, collide::polydisperse, collide::adhesion, collide::moving_bodies<collide::driven>>;
using list_24 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::sleep, collide::mesh_forces, collide::bounce, collide::spin, collide::box_walls, collide::friction, collide::emit, collide::lost_motion, collide::absorbing_box, collide::reaction, collide::gravity, collide::polydisperse, collide::moving_bodies<>>;
using list_25 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::polydisperse, collide::mesh_forces, collide::gravity, collide::emit, collide::absorbing_box, collide::lost_motion, collide::bounce, tests::pairs::warms, collide::lost, collide::adhesion, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_26 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::polydisperse, collide::mesh_forces, collide::granular_contact<collide::linear, collide::dashpot>, collide::periodic_box, collide::lost_motion, collide::sleep, collide::pair_forces, collide::moving_bodies<>>;
using list_27 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::drag, collide::wind<>, collide::mass_flow<>, collide::box_walls, collide::moving_bodies<>>;
using list_28 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_29 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::wear<>, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::polydisperse, collide::lost, collide::moving_bodies<>>;
using list_30 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::clumps, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::pair_forces, collide::lost, collide::periodic_box, collide::moving_bodies<>>;
using list_31 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::velocity_verlet, collide::gravity, collide::wind<>, tests::pairs::stirs, collide::granular_contact<collide::linear, collide::dashpot>, collide::wear<>, collide::clumps, collide::mass_flow<>, collide::absorbing_box, collide::polydisperse, collide::lost_motion, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_32 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::sleep, collide::gravity, collide::emit, collide::granular_contact<collide::linear, collide::cundall_strack, collide::marshall<collide::epsd>>, collide::wear<>, collide::contact_work<>, collide::lost, collide::reaction, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_33 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::gravity, collide::sphere_contact, collide::contact_work<>, collide::polydisperse, collide::periodic_box, collide::lost>;
using list_34 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::wear<>, collide::sleep, collide::clumps, collide::contact_work<>, collide::mesh_forces, collide::reaction, collide::polydisperse, collide::lost, collide::moving_bodies<collide::driven>>;
using list_35 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::velocity_verlet, collide::gravity, collide::granular_contact<collide::linear, collide::dashpot>, collide::sleep, collide::clumps, collide::pair_forces, tests::pairs::stirs, collide::contact_work<>, collide::mass_flow<>, collide::absorbing_box, collide::periodic_box, collide::moving_bodies<>>;
using list_36 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::sphere_contact, collide::gravity, collide::absorb, collide::clumps, collide::mass_flow<>, collide::sleep, collide::polydisperse, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
