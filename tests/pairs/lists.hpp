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
    collide::velocity_verlet, collide::sphere_contact, collide::bounce, collide::gravity, collide::lost, collide::adhesion, collide::reaction, collide::moving_bodies<>>;
using list_5 = scene_list<surface::at_rest, collide::karabassi_swept<>, double,
    collide::bounce, collide::gravity, collide::polydisperse, collide::reaction, collide::sphere_contact, collide::velocity_verlet>;
using list_6 = scene_list<surface::at_rest, collide::karabassi<>, double,
    collide::wind<>, collide::lost_motion, collide::absorbing_box, collide::emit, collide::periodic_box, collide::absorb, collide::drag, collide::box_walls>;
using list_7 = scene_list<surface::at_rest, collide::karabassi_swept<>, float,
    collide::sleep, collide::absorb, collide::drag, tests::pairs::warms, collide::wind<>, collide::lost, collide::pair_forces, collide::mesh_forces>;
using list_8 = scene_list<surface::driven_body, collide::karabassi_swept<>, float,
    collide::lost_motion, collide::emit, tests::pairs::warms, collide::velocity_verlet, collide::absorbing_box, collide::sleep, collide::periodic_box, collide::moving_bodies<collide::driven>>;
using list_9 = scene_list<surface::body, collide::karabassi_swept<>, double,
    collide::polydisperse, collide::mesh_forces, collide::pair_forces, collide::box_walls, collide::absorbing_box, collide::lost, collide::lost_motion, collide::moving_bodies<>>;
using list_10 = scene_list<surface::at_rest, collide::karabassi<>, double,
    collide::bounce, tests::pairs::warms, collide::periodic_box, collide::lost, collide::emit, collide::friction, collide::adhesion, collide::spin>;
using list_11 = scene_list<surface::driven_body, collide::karabassi_swept<>, float,
    collide::bounce, collide::friction, collide::absorb, collide::box_walls, collide::spin, collide::wind<>, collide::drag, collide::moving_bodies<collide::driven>>;
using list_12 = scene_list<surface::at_rest, collide::karabassi<>, float,
    collide::drag, collide::box_walls, collide::wind<>, collide::sphere_contact, collide::velocity_verlet, collide::gravity, collide::reaction, collide::absorb>;
using list_13 = scene_list<surface::deforming, collide::karabassi_swept<>, float,
    collide::bounce, collide::pair_forces, collide::lost_motion, collide::friction, collide::absorbing_box, collide::spin, collide::mesh_forces, collide::moving_bodies<>>;
using list_14 = scene_list<surface::deforming, collide::karabassi<>, double,
    collide::gravity, collide::reaction, collide::polydisperse, tests::pairs::warms, collide::emit, collide::sphere_contact, collide::periodic_box, collide::moving_bodies<>>;
using list_15 = scene_list<surface::body, collide::karabassi<>, double,
    collide::wind<>, collide::drag, collide::bounce, collide::adhesion, collide::polydisperse, collide::sleep, collide::absorb, collide::moving_bodies<>>;
using list_16 = scene_list<surface::body, collide::karabassi<>, double,
    collide::periodic_box, tests::pairs::warms, collide::pair_forces, collide::box_walls, collide::emit, collide::mesh_forces, collide::velocity_verlet, collide::moving_bodies<>>;
using list_17 = scene_list<surface::at_rest, collide::karabassi_swept<>, float,
    collide::absorbing_box, collide::sphere_contact, collide::box_walls, collide::bounce, collide::adhesion, collide::lost_motion, collide::gravity, collide::reaction>;
using list_18 = scene_list<surface::deforming, collide::karabassi<>, double,
    collide::absorb, collide::drag, collide::box_walls, collide::wind<>, collide::sleep, collide::moving_bodies<>>;
using list_19 = scene_list<surface::driven_body, collide::karabassi_swept<>, double,
    collide::lost, collide::absorb, collide::wind<>, collide::polydisperse, collide::bounce, collide::adhesion, collide::moving_bodies<collide::driven>>;
// clang-format on

}  // namespace tests::pairs
