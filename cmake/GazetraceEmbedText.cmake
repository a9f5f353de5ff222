# SPDX-License-Identifier: Apache-2.0
# cmake -DOUTPUT=x.cpp -DHEADER=a/b.hpp -DNAMES=kOne,kTwo -DFILES=one.html,two.css -P GazetraceEmbedText.cmake
# writes the files' texts as constants that the header declares in namespace gazetrace.
string(REPLACE "," ";" names "${NAMES}")
string(REPLACE "," ";" files "${FILES}")
set(text "// Generated from ${FILES}.\n#include \"${HEADER}\"\n\nnamespace gazetrace {\n\n")
foreach(name file IN ZIP_LISTS names files)
  file(READ "${file}" content)
  string(APPEND text "const std::string_view ${name} = R\"embedded(${content})embedded\";\n\n")
endforeach()
file(WRITE "${OUTPUT}" "${text}}  // namespace gazetrace\n")
