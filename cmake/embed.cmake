# A text file becomes a constant in a header: cmake -D IN=file -D OUT=header -D NAME=constant -P embed.cmake
file(READ "${IN}" text)
string(CONCAT header "#pragma once\n\nnamespace soapfilm {\n\n"
  "inline constexpr char ${NAME}[] = R\"embedded(${text})embedded\";\n\n}\n")
file(WRITE "${OUT}" "${header}")
