// The precompiled headers (CMakeLists.txt) need a file that they are compiled for.
