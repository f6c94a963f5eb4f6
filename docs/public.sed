# What Doxygen does not see of a header of include/collide/: what is no part of the API. Lines keep their numbers.
# namespace detail may change at any time
/^namespace detail \{/,/^\}.*namespace detail/s/.*//
# of the bases in detail/, and what stands with them, what no user sees
/^ protected:/,/^\};/{/^\};/!s/.*//}
/^\/\/\/ (Kernel|Search) functor/,/^\};/s/.*//
# members of classes that the library calls: concepts.hpp, effect.hpp, ranks.hpp and docs/extending.md say what each is for
s/^  (COLLIDE_HD(_INLINE)? )?(void|bool|detail::medium|detail::medium_at_rest) (run|is_inactive|accelerate|on_mesh_contact|after_mesh_contact|on_mesh_impulse|holds|resistance|on_pair_contact|on_mesh_overlap|try_wake|begin_step|end_step|check_parameters|for_each_part|all_gather|reduce|exchange_counts|exchange)\(/\/** \\private *\/ &/
s/^  using (value|block|reads|writes|optional_writes|optional_reads|remembers) =( |$)/\/** \\private *\/ &/
s/^  static constexpr (S initial|std::uint8_t initial|bool (saves_parameters|keeps_ids_alone|asks_forces|makes_particles|begins_on_ranks)|std::size_t copies) = /\/** \\private *\/ &/
s/^  class index/\/** \\private *\/ &/
s/^class bucket::index/\/** \\private *\/ &/
# and of laws of granular contact: law.hpp says what each is for
s/^  (COLLIDE_HD(_INLINE)? )(void|S|vec3<S>|normal_force<S>|detail::contact_material const&) (force|torque|pull|density_of|between|with_wall)\(/\/** \\private *\/ &/
# of effects that another class makes, which has their memory
s/^  (detail::impulse_counts\*|std::int64_t\*|std::size_t) (sums|sums_of_triangles|triangles|bodies|refused) = /\/** \\private *\/ &/
# overloads that end with a sentence of static_assert
/^  \/\/ .*(ends? here|arguments of another kind)/,/^$/s/.*//
