# find_package(palpable CONFIG) gives the targets palpable::static and palpable::shared.
#
# Installed as <prefix>/lib/cmake/palpable/palpable-config.cmake it finds the header and the libraries
# in <prefix>. In a source tree, set palpable_DIR to ffi/cmake; the libraries are those of
# `cargo build --release -p palpable-ffi`. PALPABLE_INCLUDE_DIR and PALPABLE_LIB_DIR override both.

if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/../include/palpable.h")
    set(_palpable_include "${CMAKE_CURRENT_LIST_DIR}/../include")
    set(_palpable_lib "${CMAKE_CURRENT_LIST_DIR}/../../target/release")
else()
    set(_palpable_include "${CMAKE_CURRENT_LIST_DIR}/../../../include")
    set(_palpable_lib "${CMAKE_CURRENT_LIST_DIR}/../..")
endif()
if(DEFINED PALPABLE_INCLUDE_DIR)
    set(_palpable_include "${PALPABLE_INCLUDE_DIR}")
endif()
if(DEFINED PALPABLE_LIB_DIR)
    set(_palpable_lib "${PALPABLE_LIB_DIR}")
endif()

function(_palpable_target kind file)
    if(TARGET palpable::${kind} OR NOT EXISTS "${file}")
        return()
    endif()
    string(TOUPPER ${kind} _palpable_type)
    add_library(palpable::${kind} ${_palpable_type} IMPORTED GLOBAL)
    set_target_properties(palpable::${kind} PROPERTIES
        IMPORTED_LOCATION "${file}"
        IMPORTED_NO_SONAME TRUE
        INTERFACE_INCLUDE_DIRECTORIES "${_palpable_include}")
endfunction()

if(WIN32)
    _palpable_target(static "${_palpable_lib}/palpable.lib")
    _palpable_target(shared "${_palpable_lib}/palpable.dll")
    if(TARGET palpable::shared)
        set_target_properties(palpable::shared PROPERTIES
            IMPORTED_IMPLIB "${_palpable_lib}/palpable.dll.lib")
    endif()
    if(TARGET palpable::static)
        set_target_properties(palpable::static PROPERTIES
            INTERFACE_LINK_LIBRARIES "kernel32;ntdll;userenv;ws2_32;dbghelp")
    endif()
else()
    _palpable_target(static "${_palpable_lib}/libpalpable.a")
    _palpable_target(shared
        "${_palpable_lib}/${CMAKE_SHARED_LIBRARY_PREFIX}palpable${CMAKE_SHARED_LIBRARY_SUFFIX}")
    if(TARGET palpable::static)
        find_package(Threads REQUIRED)
        set_target_properties(palpable::static PROPERTIES
            INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
    endif()
endif()

if(NOT TARGET palpable::static AND NOT TARGET palpable::shared)
    set(palpable_FOUND FALSE)
    set(palpable_NOT_FOUND_MESSAGE "no library in ${_palpable_lib}")
endif()
