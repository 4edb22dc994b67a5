# Most of the processor time of a build from nothing goes into reading headers. Compiled together, the files of a folder read
# them once; a file that changes costs its neighbours' time, too. ./test.sh and ./demo.sh build so, developers by default not.
option(PLENOFLAME_COMPILE_TOGETHER "Compile the files of a folder as one: half the time from nothing" OFF)

# plenoflame_compile_together(TARGET): the sources of TARGET are compiled folder by folder, so that a new file meets the names
# of its own folder only. Sources with options of their own (kernels) stay apart.
function(plenoflame_compile_together target)
  if(NOT PLENOFLAME_COMPILE_TOGETHER)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # GCC 12: what is in an unnamed namespace of an included file looks to it like a header's; and it takes one inlined
  # destructor for another.
  target_compile_options(${target} PRIVATE -Wno-subobject-linkage -Wno-free-nonheap-object)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source NORMALIZE OUTPUT_VARIABLE path)
    cmake_path(GET path PARENT_PATH folder)
    cmake_path(GET folder PARENT_PATH above)
    cmake_path(GET folder FILENAME name)
    cmake_path(GET above FILENAME area)
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${area}_${name}")
  endforeach()
endfunction()
