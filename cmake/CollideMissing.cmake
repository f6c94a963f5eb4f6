# Optional parts that were looked for and are not there.

# collide_missing(PART): notes one of them.
function(collide_missing part)
  set_property(GLOBAL APPEND_STRING PROPERTY COLLIDE_MISSING ", ${part}")
endfunction()

# collide_name_missing(): names all of them in one line.
function(collide_name_missing)
  get_property(parts GLOBAL PROPERTY COLLIDE_MISSING)
  if(parts)
    string(SUBSTRING "${parts}" 2 -1 parts)
    message(STATUS "collide: not found, and left out: ${parts}")
  endif()
endfunction()
