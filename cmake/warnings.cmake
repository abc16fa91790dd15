# Warnings for the project's own targets; users' builds see only the public headers.
add_library(splinecast_warnings INTERFACE)
target_compile_options(splinecast_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual -Wcast-align -Wdouble-promotion
  $<$<BOOL:${SPLINECAST_WERROR}>:-Werror>)
