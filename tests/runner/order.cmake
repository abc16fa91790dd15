# ctest starts tests of a higher cost first. suites_RANK has the suites of each rank, as an expression.
foreach(test ${splinecast_tests_TESTS})
  foreach(rank 4 3 2 1)
    if(test MATCHES "${suites_${rank}}")
      set_tests_properties("${test}" PROPERTIES COST ${rank})
      break()
    endif()
  endforeach()
endforeach()
