# Replaces each @part@ in a page by the file with this name, and writes a C++ file with a function that returns the
# page.
#   cmake -D PAGE=….html -D "PARTS=…,…" -D FUNCTION=… -D OUT=….cpp -P embed.cmake
file(READ ${PAGE} page)
string(REPLACE "," ";" parts "${PARTS}")
foreach(path ${parts})
  cmake_path(GET path FILENAME part)
  file(READ ${path} text)
  string(REGEX REPLACE "(//|/\\*)# sourceMappingURL=[^\n]*" "" text "${text}")  # the map file is not installed
  string(REPLACE "@${part}@" "${text}" page "${page}")
endforeach()

set(whole ${OUT}.html)
file(WRITE ${whole} "${page}")
file(READ ${whole} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
file(WRITE ${OUT} "#include \"apps/pages/templates.hpp\"

namespace splinecast::apps {

std::string_view ${FUNCTION}() noexcept {
  static constexpr unsigned char kBytes[] = {
${bytes}
  };
  return {reinterpret_cast<const char*>(kBytes), sizeof(kBytes)};
}

}  // namespace splinecast::apps
")
