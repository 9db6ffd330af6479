# Included by ctest: the tests of `program`, which is run by `emulator` where that is not empty. A test of ctest is a suite,
# or eight tests of one that has more, since a process takes as long to start as most tests take. Its name is
# `prefix`.Suite, or `prefix`.Suite.2.
execute_process(COMMAND ${emulator} ${program} --gtest_list_tests
    OUTPUT_VARIABLE listed TIMEOUT 60 COMMAND_ERROR_IS_FATAL ANY)
# Parameters, which may be anything, are behind a #.
string(REGEX REPLACE "#[^\n]*" "" listed "${listed}")
string(REGEX MATCHALL "[^\n]+" lines "${listed}")

# Files what is known of `suite`.
macro(ragtop_add_suite)
    list(LENGTH tests count)
    math(EXPR last "(${count} - 1) / 8")
    foreach(number RANGE ${last})
        math(EXPR first "8 * ${number}")
        list(SUBLIST tests ${first} 8 some)
        list(JOIN some : some)
        set(name ${prefix}.${suite})
        if(last GREATER 0)
            string(APPEND name .${number})
        endif()
        add_test(${name} ${emulator} ${program} --gtest_filter=${some})
        set_tests_properties(${name} PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77)
    endforeach()
    set(tests)
endmacro()

set(tests)
foreach(line IN LISTS lines)
    string(STRIP "${line}" word)
    if(word MATCHES "^Running main")
        continue()
    elseif(line MATCHES "^ ")
        list(APPEND tests ${suite}.${word})
        continue()
    endif()
    if(tests)
        ragtop_add_suite()
    endif()
    string(REGEX REPLACE "\\.$" "" suite "${word}")
endforeach()
ragtop_add_suite()
