/// Made by make_lists.py: lists of effects in which each pair of effects stands together, and each effect with each
/// kind of surface, narrow phase and scalar.
#pragma once

#include "check_list.hpp"

namespace tests::pairs {

// clang-format off
using list_1 = scene_list<surface::body, collide::karabassi_swept<>, double,
    collide::bounce, collide::sphere_contact, collide::gravity, collide::spin, collide::velocity_verlet, collide::friction, collide::reaction, collide::moving_bodies<>>;
using list_2 = scene_list<surface::driven_body, collide::karabassi<>, float,
    collide::sphere_contact, collide::gravity, collide::bounce, collide::pair_forces, collide::adhesion, collide::reaction, collide::mesh_forces, collide::moving_bodies<collide::driven>>;
using list_3 = scene_list<surface::at_rest, collide::karabassi<>, float,
    collide::gravity, collide::bounce, collide::friction, collide::polydisperse, collide::sphere_contact, collide::sleep, collide::spin, collide::reaction>;
using list_4 = scene_list<surface::deforming, collide::karabassi_swept<>, double,
    collide::velocity_verlet, collide::bounce, collide::gravity, collide::lost, collide::adhesion, collide::reaction, collide::moving_bodies<>>;
using list_5 = scene_list<surface::at_rest, collide::karabassi_swept<>, double,
    collide::bounce, collide::gravity, collide::polydisperse, collide::reaction, collide::sphere_contact, collide::velocity_verlet>;
using list_6 = scene_list<surface::at_rest, collide::karabassi_swept<>, double,
    collide::absorb, collide::periodic_box, collide::lost_motion, collide::drag, collide::absorbing_box, collide::wind<>, tests::pairs::warms, collide::mesh_forces>;
using list_7 = scene_list<surface::at_rest, collide::karabassi<>, float,
    collide::box_walls, collide::velocity_verlet, collide::drag, collide::emit, collide::lost, collide::periodic_box, collide::lost_motion, collide::pair_forces>;
using list_8 = scene_list<surface::body, collide::karabassi_swept<>, double,
    tests::pairs::warms, collide::pair_forces, collide::polydisperse, collide::sleep, collide::emit, collide::wind<>, collide::box_walls, collide::moving_bodies<>>;
using list_9 = scene_list<surface::deforming, collide::karabassi<>, float,
    tests::pairs::warms, collide::absorb, collide::spin, collide::wind<>, collide::lost, collide::sphere_contact, collide::absorbing_box, collide::moving_bodies<>>;
using list_10 = scene_list<surface::at_rest, collide::karabassi<>, double,
    collide::absorbing_box, collide::absorb, collide::box_walls, collide::bounce, collide::adhesion, collide::friction, collide::emit, collide::reaction>;
using list_11 = scene_list<surface::driven_body, collide::karabassi_swept<>, float,
    collide::velocity_verlet, collide::mesh_forces, collide::absorb, collide::absorbing_box, collide::polydisperse, collide::sleep, collide::lost, collide::moving_bodies<collide::driven>>;
using list_12 = scene_list<surface::deforming, collide::karabassi_swept<>, double,
    collide::periodic_box, collide::polydisperse, collide::sleep, collide::drag, collide::bounce, collide::adhesion, collide::lost_motion, collide::moving_bodies<>>;
using list_13 = scene_list<surface::driven_body, collide::karabassi<>, float,
    collide::gravity, collide::periodic_box, collide::sphere_contact, collide::drag, collide::spin, collide::emit, collide::box_walls, collide::moving_bodies<collide::driven>>;
using list_14 = scene_list<surface::driven_body, collide::karabassi<>, double,
    collide::lost_motion, collide::bounce, collide::wind<>, tests::pairs::warms, collide::gravity, collide::friction, collide::reaction, collide::moving_bodies<collide::driven>>;
using list_15 = scene_list<surface::deforming, collide::karabassi_swept<>, float,
    collide::emit, collide::bounce, collide::friction, collide::spin, collide::mesh_forces, collide::box_walls, collide::pair_forces, collide::moving_bodies<>>;
using list_16 = scene_list<surface::body, collide::karabassi_swept<>, double,
    collide::drag, collide::absorbing_box, collide::periodic_box, collide::reaction, collide::absorb, collide::gravity, collide::pair_forces, collide::moving_bodies<>>;
using list_17 = scene_list<surface::body, collide::karabassi<>, float,
    collide::lost_motion, collide::wind<>, tests::pairs::warms, collide::bounce, collide::adhesion, collide::spin, collide::velocity_verlet, collide::moving_bodies<>>;
using list_18 = scene_list<surface::body, collide::karabassi_swept<>, float,
    collide::drag, collide::periodic_box, collide::bounce, collide::lost, collide::friction, collide::mesh_forces, collide::moving_bodies<>>;
using list_19 = scene_list<surface::driven_body, collide::karabassi_swept<>, double,
    collide::reaction, collide::sleep, collide::drag, collide::lost_motion, collide::sphere_contact, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
