# Shared compile settings, and onepass_module(): one static library per top-level folder.

add_library(onepass_settings INTERFACE)
target_include_directories(onepass_settings INTERFACE ${CMAKE_SOURCE_DIR})
# -ffp-contract=off: the same expression must round the same way in every module (and in the twins).
# -Wno-restrict: g++ 12 sees overlaps in std::string's own operator+ at -O3 (GCC bug 105329).
target_compile_options(onepass_settings INTERFACE
    -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wno-restrict -Werror
    -ffp-contract=off)
target_compile_definitions(onepass_settings INTERFACE GLM_FORCE_CTOR_INIT)
if(ONEPASS_SANITIZE)
    # With sanitizers g++ 12 warns of uninitialised values inside std::regex and std::optional.
    target_compile_options(onepass_settings INTERFACE
        -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
        -Wno-maybe-uninitialized)
    target_link_options(onepass_settings INTERFACE -fsanitize=address,undefined)
endif()

# onepass_module(NAME): library onepass_NAME from every .cpp of the current folder, apart from the
# subfolders that follow EXCEPT.
function(onepass_module name)
    cmake_parse_arguments(ARG "" "" "EXCEPT;LINK" ${ARGN})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
    foreach(folder IN LISTS ARG_EXCEPT)
        list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${folder}/")
    endforeach()
    add_library(onepass_${name} STATIC ${sources})
    target_link_libraries(onepass_${name} PUBLIC onepass_settings glm::glm ${ARG_LINK})
endfunction()
