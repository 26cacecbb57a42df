#pragma once
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace perception::test {

/// Lines in fences (```) of a document that begin so, without what stands behind " #".
inline std::vector<std::string> commandsIn(const std::string& document, const std::string& begin) {
  std::vector<std::string> commands;
  std::ifstream in(document);
  bool code = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("```", 0) == 0) code = !code;
    if (code && line.rfind(begin, 0) == 0) commands.push_back(line.substr(0, line.find(" #")));
  }
  return commands;
}

/// The words of a command, its program with the path of the build.
inline std::vector<std::string> wordsOf(const std::string& command) {
  std::vector<std::string> words;
  std::istringstream in(command);
  for (std::string word; in >> word;) words.push_back(word);
  words[0] = PERCEPTION_BINARY_DIR "/bin/" + words[0];
  return words;
}

}  // namespace perception::test
