/// Made by make_lists.py: lists of effects in which each pair of effects stands together on each kind of surface,
/// with each narrow phase and each scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::gravity, collide::bounce, collide::spin, collide::friction, collide::velocity_verlet, collide::reaction, collide::moving_bodies<>>;
using list_2 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::gravity, collide::bounce, collide::adhesion, collide::sphere_contact, collide::mesh_forces, collide::pair_forces, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::bounce, collide::gravity, collide::friction, collide::spin, collide::reaction, collide::polydisperse, collide::sphere_contact, collide::sleep, collide::moving_bodies<>>;
using list_4 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::bounce, collide::adhesion, collide::reaction, collide::gravity, collide::lost, collide::velocity_verlet, collide::moving_bodies<collide::driven>>;
using list_5 = scene_list<mesh_kind::fixed, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::gravity, collide::velocity_verlet, collide::sphere_contact, collide::bounce, collide::reaction>;
using list_6 = scene_list<mesh_kind::fixed, collide::karabassi<>, float,
    collide::bounce, collide::gravity, collide::friction, collide::spin, collide::adhesion, collide::sleep, collide::mesh_forces, collide::reaction>;
using list_7 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::sphere_contact, collide::sleep, collide::gravity, collide::bounce, collide::adhesion, collide::friction, collide::spin, collide::reaction, collide::velocity_verlet, collide::moving_bodies<>>;
using list_8 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::gravity, collide::sleep, collide::velocity_verlet, collide::granular_contact<collide::linear, collide::dashpot>, collide::reaction, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_9 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::lost, collide::polydisperse, collide::gravity, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::velocity_verlet, collide::reaction, collide::pair_forces, collide::moving_bodies<>>;
using list_10 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::sleep, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::mesh_forces, collide::lost, collide::absorbing_box, collide::lost_motion, collide::emit, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_11 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    tests::pairs::warms, collide::mesh_forces, collide::lost_motion, collide::periodic_box, collide::wind<>, collide::box_walls, collide::polydisperse, collide::drag, collide::absorb, collide::moving_bodies<>>;
using list_12 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::wind<>, collide::pair_forces, collide::periodic_box, collide::bounce, collide::absorb, collide::emit, collide::absorbing_box, collide::spin, collide::moving_bodies<collide::driven>>;
using list_13 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::emit, collide::lost, collide::lost_motion, collide::box_walls, collide::bounce, tests::pairs::warms, collide::absorbing_box, collide::friction, collide::adhesion, collide::moving_bodies<>>;
using list_14 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::absorb, collide::gravity, collide::sleep, collide::sphere_contact, collide::box_walls, collide::periodic_box, tests::pairs::warms, collide::wind<>, collide::moving_bodies<collide::driven>>;
using list_15 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::absorbing_box, collide::emit, collide::absorb, collide::drag, collide::wind<>, collide::velocity_verlet, collide::gravity, collide::periodic_box, collide::reaction, collide::moving_bodies<>>;
using list_16 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::box_walls, collide::lost, collide::lost_motion, collide::sphere_contact, tests::pairs::warms, collide::spin, collide::pair_forces, collide::polydisperse, collide::moving_bodies<collide::driven>>;
using list_17 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::sleep, collide::bounce, collide::pair_forces, collide::wind<>, collide::friction, collide::drag, collide::absorb, collide::adhesion, collide::periodic_box, collide::moving_bodies<>>;
using list_18 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::periodic_box, collide::polydisperse, collide::wind<>, collide::absorb, collide::bounce, collide::lost, collide::friction, collide::adhesion, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_19 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::absorbing_box, collide::bounce, tests::pairs::warms, collide::box_walls, collide::emit, collide::friction, collide::adhesion, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_20 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::velocity_verlet, collide::sphere_contact, collide::spin, collide::lost_motion, tests::pairs::warms, collide::box_walls, collide::pair_forces, collide::mesh_forces, collide::gravity, collide::moving_bodies<>>;
using list_21 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::bounce, collide::velocity_verlet, collide::adhesion, collide::sleep, collide::lost_motion, collide::friction, collide::drag, collide::pair_forces, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_22 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::absorbing_box, collide::absorb, collide::emit, collide::lost, collide::sphere_contact, collide::spin, collide::sleep, collide::drag, collide::mesh_forces, collide::moving_bodies<>>;
using list_23 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::lost, collide::reaction, collide::sleep, collide::mesh_forces, collide::lost_motion, collide::periodic_box, tests::pairs::warms, collide::wind<>, collide::box_walls, collide::moving_bodies<>>;
using list_24 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::bounce, collide::wind<>, collide::drag, collide::periodic_box, collide::lost, collide::absorb, collide::spin, collide::reaction, collide::lost_motion, collide::moving_bodies<collide::driven>>;
using list_25 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::emit, collide::wind<>, collide::sphere_contact, collide::periodic_box, collide::polydisperse, collide::pair_forces, collide::sleep, collide::absorbing_box, collide::spin, collide::moving_bodies<>>;
using list_26 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::emit, collide::sleep, collide::polydisperse, collide::absorbing_box, collide::bounce, collide::velocity_verlet, collide::spin, collide::reaction, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_27 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sleep, collide::bounce, collide::friction, collide::spin, collide::adhesion, collide::mesh_forces, tests::pairs::warms, collide::box_walls, collide::lost, collide::moving_bodies<collide::driven>>;
using list_28 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::drag, collide::bounce, collide::sphere_contact, collide::lost_motion, collide::friction, collide::adhesion, collide::absorb, collide::mesh_forces, collide::polydisperse, collide::moving_bodies<>>;
using list_29 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::drag, collide::mesh_forces, collide::pair_forces, collide::absorb, collide::lost_motion, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_30 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::lost, collide::velocity_verlet, collide::gravity, collide::moving_bodies<>>;
using list_31 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::bounce, collide::adhesion, collide::friction, collide::moving_bodies<collide::driven>>;
using list_32 = scene_list<mesh_kind::moving, collide::karabassi<>, double,
    collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::lost, collide::periodic_box, collide::box_walls, collide::sleep, collide::pair_forces, collide::polydisperse, collide::drag, collide::absorbing_box, collide::moving_bodies<>>;
using list_33 = scene_list<mesh_kind::driven, collide::karabassi<>, float,
    collide::wind<>, collide::lost_motion, collide::emit, collide::sphere_contact, collide::granular_contact<collide::linear, collide::dashpot>, collide::gravity, collide::velocity_verlet, collide::reaction, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_34 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, float,
    collide::absorbing_box, collide::granular_contact<collide::linear, collide::dashpot>, collide::box_walls, collide::pair_forces, collide::drag, collide::sleep, collide::polydisperse, collide::periodic_box, collide::lost, collide::moving_bodies<collide::driven>>;
using list_35 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, double,
    collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::sphere_contact, collide::reaction, collide::mesh_forces, collide::emit, collide::wind<>, collide::gravity, collide::lost_motion, collide::velocity_verlet, collide::moving_bodies<>>;
using list_36 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::mass_flow<>, collide::gravity, collide::box_walls, tests::pairs::stirs, collide::sphere_contact, collide::lost_motion, tests::pairs::warms, collide::absorb, collide::lost, collide::moving_bodies<collide::driven>>;
using list_37 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::polydisperse, tests::pairs::stirs, collide::sleep, collide::mass_flow<>, collide::emit, collide::bounce, collide::friction, collide::adhesion, collide::reaction, collide::moving_bodies<>>;
using list_38 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::mass_flow<>, collide::granular_contact<collide::linear, collide::dashpot>, collide::absorbing_box, tests::pairs::stirs, collide::periodic_box, collide::drag, collide::pair_forces, collide::velocity_verlet, collide::mesh_forces, collide::moving_bodies<>>;
using list_39 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::wind<>, collide::bounce, tests::pairs::stirs, collide::velocity_verlet, collide::absorbing_box, collide::mass_flow<>, collide::drag, collide::spin, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_40 = scene_list<mesh_kind::driven, collide::karabassi<>, double,
    collide::polydisperse, collide::bounce, collide::friction, collide::adhesion, collide::emit, tests::pairs::stirs, collide::sleep, collide::mass_flow<>, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_41 = scene_list<mesh_kind::moving, collide::karabassi_swept<>, float,
    collide::mass_flow<>, collide::sphere_contact, tests::pairs::warms, collide::gravity, collide::box_walls, collide::lost, collide::lost_motion, collide::absorb, tests::pairs::stirs, collide::moving_bodies<>>;
using list_42 = scene_list<mesh_kind::driven, collide::karabassi_swept<>, double,
    collide::mass_flow<>, tests::pairs::stirs, collide::granular_contact<collide::hertz, collide::mindlin, collide::epsd>, collide::periodic_box, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_43 = scene_list<mesh_kind::moving, collide::karabassi<>, float,
    collide::spin, tests::pairs::stirs, collide::mass_flow<>, collide::wind<>, collide::sphere_contact, collide::moving_bodies<>>;
// clang-format on

}  // namespace tests::pairs
