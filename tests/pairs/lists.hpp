/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,
/// with each narrow phase and each scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::friction, collide::velocity_verlet, collide::sphere_contact, collide::spin, collide::reaction, collide::gravity, collide::moving_bodies<>>;
using list_2 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::gravity, collide::sphere_contact, collide::bounce, collide::adhesion, collide::reaction, collide::mesh_forces, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::bounce, collide::gravity, collide::sphere_contact, collide::polydisperse, collide::friction, collide::sleep, collide::spin, collide::reaction, collide::moving_bodies<>>;
using list_4 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::gravity, collide::lost, collide::bounce, collide::velocity_verlet, collide::adhesion, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_5 = scene_list<mesh_kind::fixed, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::bounce, collide::velocity_verlet, collide::sphere_contact, collide::gravity, collide::reaction>;
using list_6 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::bounce, collide::gravity, collide::friction, collide::sleep, collide::adhesion, collide::spin, collide::reaction, collide::mesh_forces>;
using list_7 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::bounce, collide::friction, collide::spin, collide::adhesion, collide::reaction, collide::sleep, collide::velocity_verlet, collide::sphere_contact, collide::gravity, collide::moving_bodies<>>;
using list_8 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::granular_contact<collide::linear, collide::dashpot>, collide::reaction, collide::sleep, collide::mesh_forces, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_9 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::reaction, collide::polydisperse, collide::velocity_verlet, collide::lost, collide::pair_forces, collide::moving_bodies<>>;
using list_10 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::sleep, collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::mesh_forces, collide::lost, collide::absorbing_box, collide::lost_motion, collide::emit, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_11 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::mass_flow<>, collide::box_walls, tests::pairs::stirs, collide::lost_motion, collide::wind<>, tests::pairs::warms, collide::bounce, collide::absorb, collide::drag, collide::pair_forces, collide::absorbing_box, collide::periodic_box, collide::moving_bodies<>>;
using list_12 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::wind<>, collide::absorb, tests::pairs::warms, collide::polydisperse, collide::mass_flow<>, collide::emit, collide::lost, collide::bounce, collide::drag, collide::friction, collide::spin, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_13 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::sphere_contact, collide::gravity, collide::absorbing_box, collide::drag, collide::box_walls, collide::granular_contact<collide::linear, collide::dashpot>, collide::periodic_box, collide::mesh_forces, collide::wind<>, tests::pairs::stirs, collide::mass_flow<>, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_14 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::lost_motion, collide::polydisperse, collide::lost, tests::pairs::stirs, collide::bounce, collide::friction, collide::spin, collide::adhesion, collide::mesh_forces, collide::emit, collide::absorbing_box, collide::box_walls, collide::moving_bodies<>>;
using list_15 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::drag, collide::periodic_box, collide::wind<>, collide::absorb, tests::pairs::warms, collide::velocity_verlet, collide::gravity, collide::reaction, collide::emit, collide::mesh_forces, collide::sleep, collide::sphere_contact, collide::moving_bodies<>>;
using list_16 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    tests::pairs::stirs, collide::sleep, collide::lost_motion, collide::bounce, collide::adhesion, tests::pairs::warms, collide::box_walls, collide::pair_forces, collide::absorb, collide::reaction, collide::mass_flow<>, collide::wind<>, collide::moving_bodies<collide::driven>>;
using list_17 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    tests::pairs::stirs, collide::gravity, collide::lost_motion, collide::mass_flow<>, collide::velocity_verlet, collide::lost, collide::sleep, collide::box_walls, collide::absorbing_box, collide::sphere_contact, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::reaction, collide::moving_bodies<>>;
using list_18 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::pair_forces, collide::bounce, collide::polydisperse, collide::velocity_verlet, collide::lost_motion, collide::adhesion, collide::spin, collide::drag, collide::sleep, collide::absorbing_box, collide::friction, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_19 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::box_walls, tests::pairs::warms, collide::bounce, collide::adhesion, tests::pairs::stirs, collide::emit, collide::friction, collide::pair_forces, collide::spin, collide::mesh_forces, collide::lost, collide::moving_bodies<collide::driven>>;
using list_20 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    tests::pairs::warms, collide::bounce, collide::spin, collide::adhesion, collide::lost, collide::mass_flow<>, collide::periodic_box, collide::absorb, collide::wind<>, collide::polydisperse, collide::drag, collide::friction, collide::moving_bodies<>>;
using list_21 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost, collide::absorbing_box, collide::gravity, collide::emit, collide::absorb, collide::sphere_contact, collide::lost_motion, collide::mesh_forces, collide::reaction, collide::velocity_verlet, tests::pairs::warms, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_22 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::sleep, collide::granular_contact<collide::linear, collide::dashpot>, collide::mesh_forces, collide::periodic_box, collide::pair_forces, collide::reaction, collide::polydisperse, collide::lost, collide::wind<>, collide::drag, collide::emit, collide::mass_flow<>, collide::moving_bodies<>>;
using list_23 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::lost_motion, collide::gravity, collide::sphere_contact, collide::bounce, collide::drag, collide::periodic_box, collide::absorbing_box, collide::adhesion, collide::spin, collide::polydisperse, collide::friction, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_24 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::sphere_contact, collide::polydisperse, collide::bounce, collide::sleep, collide::spin, collide::friction, collide::adhesion, collide::pair_forces, collide::moving_bodies<>>;
using list_25 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost_motion, collide::granular_contact<collide::linear, collide::dashpot>, collide::polydisperse, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_26 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::granular_contact<collide::hertz, collide::mindlin_force, collide::epsd2, collide::sjkr>, collide::drag, collide::periodic_box, collide::wind<>, collide::moving_bodies<>>;
using list_27 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::mass_flow<>, collide::emit, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
