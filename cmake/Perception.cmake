# Build helpers: warnings and sanitizers of our own code, one static library a module, one program an app folder.

find_package(Eigen3 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(octomap REQUIRED)
find_package(embree 3 REQUIRED)
# Debian's OpenCVConfig.cmake comes only with the package of all OpenCV modules: name the few that are used.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(part core imgproc imgcodecs dnn objdetect dpm)
  find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
  add_library(opencv_${part} UNKNOWN IMPORTED)
  set_target_properties(opencv_${part} PROPERTIES IMPORTED_LOCATION ${OPENCV_${part}_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
endforeach()
find_package(TBB REQUIRED)
find_package(NLopt REQUIRED)
find_package(tinyxml2 REQUIRED)
find_package(ZLIB REQUIRED)
foreach(part obs maps bayes random io opengl img config system hwdrivers topography)
  find_package(mrpt-${part} REQUIRED)
endforeach()

add_library(perception_options INTERFACE)
target_compile_options(perception_options INTERFACE -Wall -Wextra -Wconversion $<$<BOOL:${PERCEPTION_WERROR}>:-Werror>)
target_include_directories(perception_options INTERFACE ${CMAKE_SOURCE_DIR})
if(PERCEPTION_SANITIZE)
  # Debian's MRPT hands out OpenGL objects that are not aligned as its headers say: no alignment check.
  target_compile_options(perception_options INTERFACE -fsanitize=${PERCEPTION_SANITIZE} -fno-sanitize=alignment
                         -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(perception_options INTERFACE -fsanitize=${PERCEPTION_SANITIZE})
endif()

# perception_module(NAME [FOLDER dir] LINK libs...): all of libperception/NAME/*.cpp as perception::NAME.
function(perception_module NAME)
  cmake_parse_arguments(ARG "" "FOLDER" "LINK" ${ARGN})
  if(NOT ARG_FOLDER)
    set(ARG_FOLDER libperception/${NAME})
  endif()
  list(REMOVE_ITEM ARG_LINK MRPT)
  file(GLOB SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${ARG_FOLDER}/*.cpp)
  if(SOURCES)
    add_library(perception_${NAME} STATIC ${SOURCES})
    target_link_libraries(perception_${NAME} PUBLIC perception_options ${ARG_LINK})
  else()
    add_library(perception_${NAME} INTERFACE)
    target_link_libraries(perception_${NAME} INTERFACE perception_options ${ARG_LINK})
  endif()
  add_library(perception::${NAME} ALIAS perception_${NAME})
endfunction()

# perception_simd(NAME STEM): STEM{Sse2,Avx2,Avx512}.cpp join module NAME, each for its own kind of processor. They are
# chosen at run time, so the rest of the module stays at the baseline.
function(perception_simd NAME STEM)
  set(MATH -O3 -fno-math-errno -ffp-contract=fast)
  foreach(LEVEL Sse2 Avx2 Avx512)
    target_sources(perception_${NAME} PRIVATE ${CMAKE_SOURCE_DIR}/${STEM}${LEVEL}.cpp)
  endforeach()
  set_source_files_properties(${CMAKE_SOURCE_DIR}/${STEM}Sse2.cpp PROPERTIES COMPILE_OPTIONS "${MATH}")
  set_source_files_properties(${CMAKE_SOURCE_DIR}/${STEM}Avx2.cpp PROPERTIES COMPILE_OPTIONS "${MATH};-mavx2;-mfma")
  set_source_files_properties(${CMAKE_SOURCE_DIR}/${STEM}Avx512.cpp PROPERTIES
    COMPILE_OPTIONS "${MATH};-mavx512f;-mavx512dq;-mavx512vl;-mfma;-mprefer-vector-width=512")
endfunction()

# Every folder apps/X holds X_main.cpp and becomes the program build/bin/X.
function(perception_apps)
  file(GLOB MAINS CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/apps/*/*_main.cpp)
  foreach(MAIN ${MAINS})
    get_filename_component(DIR ${MAIN} DIRECTORY)
    get_filename_component(APP ${DIR} NAME)
    add_executable(${APP} ${MAIN})
    target_link_libraries(${APP} PRIVATE perception::app)
  endforeach()
endfunction()

# The observation classes and drivers as a plugin for stock MRPT tools (rawlog-edit -p, RawLogViewer -l, rawlog-grabber -p).
function(perception_plugin)
  add_library(perception_mrpt_plugin MODULE ${CMAKE_SOURCE_DIR}/libperception/capture/plugin/Plugin.cpp)
  target_link_libraries(perception_mrpt_plugin PRIVATE perception::capture)
endfunction()
