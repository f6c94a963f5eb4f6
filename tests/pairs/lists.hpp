/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,
/// with each narrow phase and each scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::spin, collide::friction, collide::reaction, collide::velocity_verlet, collide::gravity, collide::sphere_contact, collide::moving_bodies<>>;
using list_2 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::bounce, collide::adhesion, collide::reaction, collide::sphere_contact, collide::gravity, collide::mesh_forces, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::sphere_contact, collide::polydisperse, collide::sleep, collide::gravity, collide::bounce, collide::spin, collide::friction, collide::reaction, collide::moving_bodies<>>;
using list_4 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::gravity, collide::lost, collide::velocity_verlet, collide::bounce, collide::adhesion, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_5 = scene_list<mesh_kind::fixed, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::gravity, collide::polydisperse, collide::velocity_verlet, collide::bounce, collide::reaction>;
using list_6 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::bounce, collide::spin, collide::gravity, collide::adhesion, collide::sleep, collide::friction, collide::reaction, collide::mesh_forces>;
using list_7 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::emit, collide::box_walls, collide::velocity_verlet, collide::wind<>, collide::drag, collide::absorb, collide::lost_motion, tests::pairs::warms, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_8 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::absorbing_box, collide::polydisperse, collide::box_walls, collide::lost, collide::mesh_forces, tests::pairs::warms, collide::periodic_box, collide::emit, collide::absorb, collide::moving_bodies<>>;
using list_9 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::lost_motion, collide::drag, collide::periodic_box, collide::sleep, collide::sphere_contact, collide::wind<>, collide::spin, collide::lost, collide::absorbing_box, collide::moving_bodies<collide::driven>>;
using list_10 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::bounce, collide::drag, collide::absorbing_box, collide::adhesion, collide::lost_motion, collide::wind<>, collide::pair_forces, collide::periodic_box, collide::friction, collide::moving_bodies<>>;
using list_11 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    tests::pairs::warms, collide::emit, collide::absorb, collide::bounce, collide::box_walls, collide::sleep, collide::adhesion, collide::friction, collide::spin, collide::moving_bodies<collide::driven>>;
using list_12 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::drag, tests::pairs::warms, collide::gravity, collide::emit, collide::box_walls, collide::wind<>, collide::reaction, collide::sphere_contact, collide::lost_motion, collide::moving_bodies<>>;
using list_13 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::drag, collide::mesh_forces, collide::polydisperse, collide::wind<>, collide::velocity_verlet, collide::lost_motion, collide::sleep, collide::pair_forces, collide::lost, collide::moving_bodies<>>;
using list_14 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::absorbing_box, collide::gravity, collide::periodic_box, collide::polydisperse, tests::pairs::warms, collide::box_walls, collide::reaction, collide::absorb, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_15 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::sleep, collide::absorb, collide::bounce, collide::spin, collide::sphere_contact, collide::pair_forces, collide::emit, collide::adhesion, collide::mesh_forces, collide::moving_bodies<>>;
using list_16 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::polydisperse, collide::emit, collide::periodic_box, collide::lost, collide::absorbing_box, collide::bounce, collide::friction, collide::adhesion, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_17 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::sphere_contact, collide::spin, collide::absorb, collide::sleep, collide::absorbing_box, collide::periodic_box, collide::gravity, collide::reaction, collide::moving_bodies<>>;
using list_18 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::bounce, collide::friction, collide::reaction, collide::mesh_forces, collide::polydisperse, collide::gravity, collide::wind<>, collide::lost_motion, collide::moving_bodies<collide::driven>>;
using list_19 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    tests::pairs::warms, collide::pair_forces, collide::polydisperse, collide::lost, collide::bounce, collide::adhesion, collide::spin, collide::friction, collide::box_walls, collide::moving_bodies<>>;
using list_20 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::sphere_contact, collide::box_walls, collide::spin, collide::sleep, collide::mesh_forces, collide::lost, collide::velocity_verlet, tests::pairs::warms, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_21 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::lost_motion, collide::wind<>, collide::absorb, collide::emit, collide::bounce, collide::spin, collide::drag, collide::friction, collide::mesh_forces, collide::moving_bodies<>>;
using list_22 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::polydisperse, collide::pair_forces, collide::gravity, collide::reaction, collide::absorbing_box, collide::velocity_verlet, collide::periodic_box, collide::sleep, collide::emit, collide::moving_bodies<collide::driven>>;
using list_23 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::lost, collide::mesh_forces, tests::pairs::warms, collide::velocity_verlet, collide::box_walls, collide::sleep, collide::sphere_contact, collide::reaction, collide::emit, collide::moving_bodies<>>;
using list_24 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::emit, collide::sphere_contact, collide::bounce, collide::box_walls, collide::adhesion, collide::friction, collide::absorb, tests::pairs::warms, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_25 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::pair_forces, collide::sleep, collide::bounce, collide::emit, collide::adhesion, collide::gravity, collide::mesh_forces, collide::reaction, collide::lost, collide::moving_bodies<>>;
using list_26 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::bounce, collide::friction, collide::adhesion, collide::periodic_box, collide::absorbing_box, collide::wind<>, collide::lost_motion, collide::moving_bodies<collide::driven>>;
using list_27 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::sphere_contact, collide::spin, collide::polydisperse, collide::gravity, collide::mesh_forces, collide::reaction, collide::emit, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_28 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::lost, collide::absorb, collide::moving_bodies<collide::driven>>;
using list_29 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::lost, collide::absorb, collide::moving_bodies<collide::driven>>;
using list_30 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::bounce, collide::adhesion, collide::moving_bodies<>>;
using list_31 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::bounce, collide::sleep, collide::friction, collide::moving_bodies<>>;
using list_32 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::velocity_verlet, collide::box_walls, collide::wind<>, collide::drag, collide::pair_forces, collide::periodic_box, collide::gravity, collide::polydisperse, collide::moving_bodies<collide::driven>>;
using list_33 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::emit, collide::granular_contact<collide::linear, collide::dashpot>, collide::lost, collide::sphere_contact, collide::reaction, collide::lost_motion, collide::absorbing_box, collide::mesh_forces, collide::sleep, collide::moving_bodies<>>;
using list_34 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::polydisperse, collide::velocity_verlet, collide::box_walls, collide::wind<>, collide::granular_contact<collide::linear, collide::dashpot>, collide::periodic_box, collide::drag, collide::gravity, collide::pair_forces, collide::moving_bodies<>>;
using list_35 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::sleep, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mesh_forces, collide::lost, collide::absorbing_box, collide::lost_motion, collide::emit, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_36 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::wind<>, collide::polydisperse, collide::gravity, collide::drag, collide::box_walls, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::pair_forces, collide::velocity_verlet, collide::periodic_box, collide::moving_bodies<>>;
using list_37 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::mass_flow<>, collide::drag, tests::pairs::warms, collide::absorb, tests::pairs::stirs, collide::emit, collide::bounce, collide::velocity_verlet, collide::adhesion, collide::moving_bodies<collide::driven>>;
using list_38 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::polydisperse, collide::spin, collide::lost, collide::gravity, tests::pairs::stirs, collide::mass_flow<>, collide::sphere_contact, collide::absorbing_box, collide::sleep, collide::moving_bodies<>>;
using list_39 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::box_walls, collide::granular_contact<collide::linear, collide::dashpot>, collide::periodic_box, collide::mass_flow<>, collide::lost_motion, collide::mesh_forces, collide::wind<>, collide::reaction, tests::pairs::stirs, collide::moving_bodies<>>;
using list_40 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::mass_flow<>, collide::emit, collide::absorb, collide::velocity_verlet, tests::pairs::stirs, collide::pair_forces, collide::bounce, collide::adhesion, collide::friction, collide::moving_bodies<>>;
using list_41 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::wind<>, collide::lost_motion, collide::periodic_box, collide::box_walls, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mesh_forces, collide::mass_flow<>, collide::reaction, tests::pairs::stirs, collide::moving_bodies<collide::driven>>;
using list_42 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::polydisperse, collide::sphere_contact, collide::spin, collide::absorbing_box, collide::sleep, collide::lost, tests::pairs::stirs, collide::gravity, collide::mass_flow<>, collide::moving_bodies<collide::driven>>;
using list_43 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::bounce, collide::drag, tests::pairs::stirs, tests::pairs::warms, collide::mass_flow<>, collide::friction, collide::moving_bodies<>>;
using list_44 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::mass_flow<>, tests::pairs::stirs, collide::pair_forces, collide::bounce, collide::friction, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
