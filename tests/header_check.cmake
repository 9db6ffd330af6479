# Every public header compiles on its own: a source for each, which reads nothing before it.
foreach(module IN LISTS modules)
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS
        RELATIVE ${PROJECT_SOURCE_DIR}/${module}/include ${PROJECT_SOURCE_DIR}/${module}/include/*.h)
    foreach(header IN LISTS headers)
        string(REPLACE "/" "_" name ${header})
        file(CONFIGURE OUTPUT header_check/${name}.cpp CONTENT "#include <${header}>\n")
        list(APPEND header_sources ${CMAKE_CURRENT_BINARY_DIR}/header_check/${name}.cpp)
    endforeach()
endforeach()
