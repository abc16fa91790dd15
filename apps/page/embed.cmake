# Makes one page of its parts and a C++ file that holds it.
#   cmake -D PAGE_DIR=… -D DYGRAPHS_DIR=… -D OUT=….cpp -P embed.cmake
file(READ ${PAGE_DIR}/report.html page)
foreach(part report.css values.js marks.js charts.js tables.js page.js dygraph.min.css
             dygraph.min.js)
  if(part MATCHES "^dygraph")
    file(READ ${DYGRAPHS_DIR}/${part} text)
  else()
    file(READ ${PAGE_DIR}/${part} text)
  endif()
  string(REGEX REPLACE "(//|/\\*)# sourceMappingURL=[^\n]*" "" text "${text}")  # a file not there
  string(REPLACE "@${part}@" "${text}" page "${page}")
endforeach()

set(whole ${OUT}.html)
file(WRITE ${whole} "${page}")
file(READ ${whole} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
file(WRITE ${OUT} "#include \"support/report_template.hpp\"

namespace splinecast::apps {
namespace {

constexpr unsigned char kBytes[] = {
${bytes}
};

}  // namespace

std::string_view report_template() noexcept {
  return {reinterpret_cast<const char*>(kBytes), sizeof(kBytes)};
}

}  // namespace splinecast::apps
")
