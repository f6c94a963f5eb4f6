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
using list_6 = scene_list<surface::at_rest, collide::karabassi<>, double,
    collide::periodic_box, collide::emit, collide::absorb, collide::wind<>, collide::absorbing_box, collide::drag, collide::lost_motion, collide::box_walls>;
using list_7 = scene_list<surface::at_rest, collide::karabassi_swept<>, float,
    collide::lost_motion, collide::absorb, tests::pairs::warms, collide::mesh_forces, collide::absorbing_box, collide::lost, collide::sphere_contact, collide::pair_forces>;
using list_8 = scene_list<surface::deforming, collide::karabassi_swept<>, float,
    collide::drag, collide::velocity_verlet, collide::mesh_forces, collide::wind<>, collide::sleep, collide::box_walls, collide::periodic_box, collide::moving_bodies<>>;
using list_9 = scene_list<surface::body, collide::karabassi_swept<>, double,
    collide::emit, collide::sleep, collide::sphere_contact, collide::polydisperse, collide::drag, tests::pairs::warms, collide::pair_forces, collide::moving_bodies<>>;
using list_10 = scene_list<surface::driven_body, collide::karabassi<>, double,
    tests::pairs::warms, collide::wind<>, collide::box_walls, collide::spin, collide::lost, collide::sphere_contact, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_11 = scene_list<surface::at_rest, collide::karabassi<>, float,
    collide::absorbing_box, collide::bounce, collide::friction, collide::adhesion, collide::absorb, collide::emit, collide::velocity_verlet, collide::lost_motion>;
using list_12 = scene_list<surface::driven_body, collide::karabassi_swept<>, float,
    collide::lost_motion, collide::sleep, collide::reaction, collide::absorbing_box, collide::polydisperse, collide::gravity, collide::absorb, collide::moving_bodies<collide::driven>>;
using list_13 = scene_list<surface::body, collide::karabassi_swept<>, double,
    collide::wind<>, collide::bounce, collide::periodic_box, collide::box_walls, collide::adhesion, collide::gravity, collide::polydisperse, collide::moving_bodies<>>;
using list_14 = scene_list<surface::deforming, collide::karabassi_swept<>, double,
    collide::pair_forces, collide::emit, collide::bounce, collide::friction, collide::spin, collide::mesh_forces, collide::drag, collide::moving_bodies<>>;
using list_15 = scene_list<surface::driven_body, collide::karabassi<>, double,
    collide::drag, collide::reaction, collide::emit, collide::lost, collide::sphere_contact, tests::pairs::warms, collide::gravity, collide::moving_bodies<collide::driven>>;
using list_16 = scene_list<surface::at_rest, collide::karabassi_swept<>, double,
    collide::wind<>, collide::pair_forces, collide::periodic_box, collide::bounce, collide::box_walls, collide::friction, collide::lost, collide::reaction>;
using list_17 = scene_list<surface::deforming, collide::karabassi<>, float,
    collide::sphere_contact, tests::pairs::warms, collide::spin, collide::polydisperse, collide::lost_motion, collide::absorbing_box, collide::absorb, collide::moving_bodies<>>;
using list_18 = scene_list<surface::body, collide::karabassi<>, float,
    collide::mesh_forces, collide::absorb, collide::lost_motion, collide::sleep, collide::absorbing_box, collide::lost, collide::polydisperse, collide::moving_bodies<>>;
using list_19 = scene_list<surface::driven_body, collide::karabassi_swept<>, double,
    collide::sphere_contact, collide::bounce, collide::friction, collide::velocity_verlet, tests::pairs::warms, collide::adhesion, collide::pair_forces, collide::moving_bodies<collide::driven>>;
using list_20 = scene_list<surface::driven_body, collide::karabassi_swept<>, float,
    collide::bounce, collide::adhesion, collide::drag, collide::spin, collide::sleep, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
