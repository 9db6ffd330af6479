# What every target of the project shares: language level, warnings, floating-point rules, sanitizers.

if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
    find_program(RAGTOP_CCACHE ccache)
    if(RAGTOP_CCACHE)
        # Without this sloppiness ccache leaves sources with precompiled headers alone.
        set(ccache_settings CCACHE_SLOPPINESS=pch_defines,time_macros)
        # What a source includes is taken from the compiler: a cache that has no entry costs no second preprocessing. Trees
        # that share a cache (CCACHE_BASEDIR) find each other's entries by the preprocessed text alone.
        if(NOT DEFINED ENV{CCACHE_BASEDIR})
            list(APPEND ccache_settings CCACHE_DEPEND=1)
        endif()
        set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env ${ccache_settings} ${RAGTOP_CCACHE})
    endif()
endif()

# Contraction would fuse a*b+c differently per compiler and target; results must agree to the bit everywhere.
# Consumers get it too: they instantiate the same inline functions, and the linker keeps any one copy.
set(RAGTOP_PUBLIC_OPTIONS -ffp-contract=off)
# The alignment of Eigen's fixed-size types must not depend on the -m options of a source file.
set(RAGTOP_PUBLIC_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)

# ragtop_target(<target> [TEST]): TEST drops the warnings that GTest's macros and literal-heavy checks trip, and optimises
# less.
function(ragtop_target target)
    cmake_parse_arguments(PARSE_ARGV 1 arg "TEST" "" "")
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_compile_options(${target} PRIVATE
        -Wall -Wextra -Wshadow $<$<BOOL:${RAGTOP_WARNINGS_AS_ERRORS}>:-Werror> -Wno-psabi
        -ffp-contract=off -fno-math-errno
        # g++ collects its garbage from 128 MB on, most of which is in use: 5 to 14 % of its time.
        $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>
        # g++ 12 reports overlapping copies inside std::string that cannot happen (GCC bug 105329).
        $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
    # Where it is not optimised away, std::variant makes g++ 12 report reads that do not happen (GCC bug 105562).
    set(without_false_reads $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    if(arg_TEST)
        # What is tested is optimised; tests themselves compile in two thirds of the time.
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1> ${without_false_reads}
            # As of strings that are added up (GCC bug 105651).
            $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
            $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
    else()
        target_compile_options(${target} PRIVATE -Wpedantic -Wconversion)
    endif()
    if(RAGTOP_SANITIZE)
        target_compile_options(${target} PRIVATE
            -fsanitize=${RAGTOP_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
            ${without_false_reads})
        target_link_options(${target} PUBLIC -fsanitize=${RAGTOP_SANITIZE})
    endif()
endfunction()

# ragtop_module(<name> [STATIC] [FOLDER <folder>] [WITHOUT <folder>]): the library ragtop::<name> from src/**, or from
# one folder in there, or from all but one folder; with public headers in include/.
function(ragtop_module name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "STATIC" "FOLDER;WITHOUT" "")
    cmake_path(APPEND folder src ${arg_FOLDER})
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${folder}/*.cpp ${folder}/*.h include/*.h)
    if(arg_WITHOUT)
        list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/src/${arg_WITHOUT}/")
    endif()
    # A program's entry point and the kernels of optional instruction sets are added where they apply.
    list(FILTER sources EXCLUDE REGEX "/main\\.cpp$|/[a-z]+_[a-z]+_(avx2|avx2_lanes16|avx512)\\.cpp$")
    set(type)
    if(arg_STATIC)
        set(type STATIC)
    endif()
    add_library(ragtop_${name} ${type} ${sources})
    add_library(ragtop::${name} ALIAS ragtop_${name})
    set_target_properties(ragtop_${name} PROPERTIES
        EXPORT_NAME ${name}
        VERSION ${PROJECT_VERSION}
        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
        INSTALL_RPATH "$ORIGIN")
    ragtop_target(ragtop_${name})
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include)
        target_include_directories(ragtop_${name} PUBLIC
            $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
            $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    endif()
    target_include_directories(ragtop_${name} PRIVATE src)
endfunction()

# ragtop_precompile(<target> <header>... | REUSE_FROM <target>): parses these once for all sources of a target that no
# other project builds, or takes what another target of the same options has parsed: parsing is most of what compiling
# tests and programs costs. Every source still names what it uses.
# Headers of other projects alone: a cached one of ours would name the checkout that it was made in.
function(ragtop_precompile target)
    if(NOT RAGTOP_PRECOMPILE)
        return()
    endif()
    if(ARGV1 STREQUAL "REUSE_FROM")
        target_precompile_headers(${target} ${ARGN})
    else()
        target_precompile_headers(${target} PRIVATE ${ARGN})
    endif()
    # From a precompiled std::string g++ 12 reports overflows that cannot happen (GCC bug 105651).
    target_compile_options(${target} PRIVATE
        $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
endfunction()

# ragtop_unity(<target> [MOST <number>] [ALONE <regex>] [TOGETHER <regex>]): compiles many sources at a time, in units of
# the same size with at most 8 of them, or another number. Their headers, and what templates make of those again in each
# unit, are most of what they cost. Sources whose paths match ALONE use the same names for different things and stay alone;
# those that match TOGETHER share headers that few others include, and are compiled with each other. Call it when the
# target has all its sources.
function(ragtop_unity target)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "MOST;ALONE;TOGETHER" "")
    if(NOT RAGTOP_UNITY)
        return()
    endif()
    if(NOT arg_MOST)
        set(arg_MOST 8)
    endif()
    get_target_property(sources ${target} SOURCES)
    if(arg_TOGETHER)
        set(together ${sources})
        list(FILTER together INCLUDE REGEX "${arg_TOGETHER}")
        list(REMOVE_ITEM sources ${together})
        list(PREPEND sources ${together})
        set_property(TARGET ${target} PROPERTY SOURCES ${sources})
    endif()
    list(FILTER sources INCLUDE REGEX "\\.cpp$")
    if(arg_ALONE)
        set(alone ${sources})
        list(FILTER alone INCLUDE REGEX "${arg_ALONE}")
        set_source_files_properties(${alone} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
        list(FILTER sources EXCLUDE REGEX "${arg_ALONE}")
    endif()
    list(LENGTH sources count)
    math(EXPR units "(${count} + ${arg_MOST} - 1) / ${arg_MOST}")
    if(units GREATER 0)
        math(EXPR size "(${count} + ${units} - 1) / ${units}")
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
    endif()
endfunction()

# ragtop_cold(<target>): no step runs any of it, and it compiles in 0.7 (files) to 0.8 (templates of Boost) of the time.
function(ragtop_cold target)
    # At -O1 g++ takes an optional that is asked first for one that is not set.
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()

# ragtop_use_headers(<target> <package target>...): compiles against header-only packages without linking them,
# so that they stay out of the exported targets and consumers need not have them.
function(ragtop_use_headers target)
    foreach(package IN LISTS ARGN)
        target_include_directories(${target} SYSTEM PRIVATE
            $<TARGET_PROPERTY:${package},INTERFACE_INCLUDE_DIRECTORIES>)
        target_compile_definitions(${target} PRIVATE
            $<TARGET_PROPERTY:${package},INTERFACE_COMPILE_DEFINITIONS>)
    endforeach()
endfunction()
