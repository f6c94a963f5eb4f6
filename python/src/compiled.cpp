// Nothing: libcollide_python.so is what the archive of collide::compiled has.
