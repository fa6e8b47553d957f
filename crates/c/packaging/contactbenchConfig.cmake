# Targets contactbench::contactbench (shared) and contactbench::static.
get_filename_component(_contactbench_prefix "${CMAKE_CURRENT_LIST_DIR}/../@UP@" ABSOLUTE)
if(NOT TARGET contactbench::contactbench)
    add_library(contactbench::contactbench SHARED IMPORTED)
    set_target_properties(contactbench::contactbench PROPERTIES
        IMPORTED_LOCATION "${_contactbench_prefix}/@LIB@/@SHARED@"
        INTERFACE_INCLUDE_DIRECTORIES "${_contactbench_prefix}/include")
    add_library(contactbench::static STATIC IMPORTED)
    set_target_properties(contactbench::static PROPERTIES
        IMPORTED_LOCATION "${_contactbench_prefix}/@LIB@/libcontactbench.a"
        INTERFACE_LINK_LIBRARIES "@STATIC@"
        INTERFACE_INCLUDE_DIRECTORIES "${_contactbench_prefix}/include")
endif()
