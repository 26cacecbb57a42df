# Build helpers: warnings and sanitizers of our own code, one static library a module, one program an app folder.

find_package(Eigen3 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(octomap REQUIRED)
find_package(embree REQUIRED)  # 3 or 4
# Debian's OpenCVConfig.cmake comes only with the package of all OpenCV modules: name the few that are used.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(part core imgproc imgcodecs video calib3d dnn objdetect ml)
  find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
  add_library(opencv_${part} UNKNOWN IMPORTED)
  set_target_properties(opencv_${part} PROPERTIES IMPORTED_LOCATION ${OPENCV_${part}_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
  list(APPEND OPENCV_LIBRARIES ${OPENCV_${part}_LIBRARY})
endforeach()
find_package(TBB REQUIRED)
find_package(CycloneDDS REQUIRED)
find_package(NLopt REQUIRED)
find_package(tinyxml2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
foreach(part obs maps bayes random io opengl img config system hwdrivers topography)
  find_package(mrpt-${part} REQUIRED)
endforeach()

add_library(perception_options INTERFACE)
target_compile_options(perception_options INTERFACE -Wall -Wextra -Wconversion $<$<BOOL:${PERCEPTION_WERROR}>:-Werror>
                       $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>)  # g++ does not count it as a conversion
target_include_directories(perception_options INTERFACE ${CMAKE_SOURCE_DIR})
if(PERCEPTION_SANITIZE)
  # Debian's MRPT hands out OpenGL objects that are not aligned as its headers say: no alignment check.
  target_compile_options(perception_options INTERFACE -fsanitize=${PERCEPTION_SANITIZE} -fno-sanitize=alignment
                         -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(perception_options INTERFACE -fsanitize=${PERCEPTION_SANITIZE})
endif()

# perception_batches(TARGET): several sources at once, so that the headers that they have in common are read once: whole builds
# take half the time. Not beside ccache, which remembers sources one by one. Names of anonymous namespaces are unique in a module.
function(perception_batches TARGET)
  if(PERCEPTION_UNITY)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 24)
    target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)  # a source of a batch counts as a header
  endif()
endfunction()

# perception_cheap(TARGET): of code that runs once or waits for files, -O1, which guesses more of uninitialized variables than -O3
# knows.
function(perception_cheap TARGET)
  target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1> $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endfunction()

# perception_module(NAME [FOLDER dir] LINK libs...): all sources below libperception/NAME as perception::NAME, but those
# of simd/ kernels (see perception_simd) and of plugins.
function(perception_module NAME)
  cmake_parse_arguments(ARG "" "FOLDER" "LINK" ${ARGN})
  if(NOT ARG_FOLDER)
    set(ARG_FOLDER libperception/${NAME})
  endif()
  list(REMOVE_ITEM ARG_LINK MRPT)
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${ARG_FOLDER}/*.cpp)
  if(NOT PERCEPTION_DPM)
    list(FILTER SOURCES EXCLUDE REGEX "/dpm/")
  endif()
  list(FILTER SOURCES EXCLUDE REGEX "(/plugin/|Kernels(Sse2|Avx2|Avx512)[.]cpp$)")
  if(SOURCES)
    add_library(perception_${NAME} STATIC ${SOURCES})
    target_link_libraries(perception_${NAME} PUBLIC perception_options ${ARG_LINK})
    if(NAME IN_LIST PERCEPTION_LOOPS)
      target_compile_options(perception_${NAME} PRIVATE -fno-math-errno -fno-trapping-math -ffp-contract=off -Wno-psabi)
    elseif(NAME IN_LIST PERCEPTION_CHEAP)
      perception_cheap(perception_${NAME})
    elseif(NAME IN_LIST PERCEPTION_MODERATE)
      target_compile_options(perception_${NAME} PRIVATE $<$<CONFIG:Release>:-O2>)
    endif()
    perception_batches(perception_${NAME})
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

# Programs find OpenCV's library of picture files under its name as a library of ours that loads it when the first picture comes:
# it takes three times as long as all others together (docs/decisions/build.md). A program that is copied elsewhere, and a build
# where the name is not known, have OpenCV's own.
if(PERCEPTION_LATE_IMAGE_CODECS)
  execute_process(COMMAND ${CMAKE_READELF} -d ${OPENCV_imgcodecs_LIBRARY} OUTPUT_VARIABLE DYNAMIC ERROR_QUIET)
  if(DYNAMIC MATCHES "soname: \\[([^]]+)\\]")
    set(IMAGE_CODECS ${CMAKE_MATCH_1})
    get_filename_component(FOLDER ${OPENCV_imgcodecs_LIBRARY} DIRECTORY)
    add_library(perception_image_codecs SHARED ${CMAKE_SOURCE_DIR}/libperception/pictures/LateImageCodecs.cpp)
    target_compile_definitions(perception_image_codecs PRIVATE PERCEPTION_IMAGE_CODECS="${FOLDER}/${IMAGE_CODECS}")
    target_include_directories(perception_image_codecs SYSTEM PRIVATE ${OPENCV_INCLUDE_DIR})
    target_link_libraries(perception_image_codecs PRIVATE perception_options ${CMAKE_DL_LIBS})
    target_link_options(perception_image_codecs PRIVATE -Wl,-Bsymbolic-functions)
    set_target_properties(perception_image_codecs PROPERTIES PREFIX "" OUTPUT_NAME ${IMAGE_CODECS} SUFFIX ""
                          LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/${PLUGIN_DIR})  # as installed
    add_custom_command(TARGET perception_image_codecs POST_BUILD VERBATIM
      COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DOURS=$<TARGET_FILE:perception_image_codecs> -DTHEIRS=${FOLDER}/${IMAGE_CODECS}
              "-DUSERS=$<TARGET_FILE:mrpt::img>;${OPENCV_LIBRARIES}" -P ${CMAKE_SOURCE_DIR}/cmake/ImageCodecsCheck.cmake)
  endif()
endif()

# perception_late_image_codecs(TARGET): for programs, also of tests. First on the command line: of libraries of one name linkers
# take the first.
function(perception_late_image_codecs TARGET)
  if(TARGET perception_image_codecs)
    add_dependencies(${TARGET} perception_image_codecs)
    target_link_options(${TARGET} PRIVATE
                        LINKER:--push-state,--no-as-needed,$<TARGET_FILE:perception_image_codecs>,--pop-state)
    file(RELATIVE_PATH BESIDE /${CMAKE_INSTALL_BINDIR} /${PLUGIN_DIR})
    set_target_properties(${TARGET} PROPERTIES BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "\$ORIGIN/${BESIDE}")
  endif()
endfunction()

# perception_program(NAME [SOURCES stems or patterns below libperception...] LINK libs...): the program build/bin/perception-NAME from
# apps/perception-NAME, and perception::app_NAME with its class, for tests. It builds what it runs and nothing else.
function(perception_program NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(PROGRAM perception-${NAME})
  add_executable(${PROGRAM} ${CMAKE_SOURCE_DIR}/apps/${PROGRAM}/${PROGRAM}_main.cpp)
  set_property(GLOBAL APPEND PROPERTY PERCEPTION_PROGRAMS ${PROGRAM})
  perception_late_image_codecs(${PROGRAM})
  # The loader looks for a name in one library after the other, and finds most in these two.
  target_link_options(${PROGRAM} PRIVATE LINKER:--push-state,--no-as-needed,$<TARGET_FILE:mrpt::expr>,-lstdc++,--pop-state)
  if(ARG_SOURCES)
    list(TRANSFORM ARG_SOURCES PREPEND ${CMAKE_SOURCE_DIR}/libperception/)
    list(TRANSFORM ARG_SOURCES APPEND .cpp)
    file(GLOB SOURCES CONFIGURE_DEPENDS ${ARG_SOURCES})
    add_library(perception_app_${NAME} STATIC ${SOURCES})
    target_link_libraries(perception_app_${NAME} PUBLIC perception::app ${ARG_LINK})
    perception_cheap(perception_app_${NAME})
    perception_batches(perception_app_${NAME})
    add_library(perception::app_${NAME} ALIAS perception_app_${NAME})
    target_link_libraries(${PROGRAM} PRIVATE perception::app_${NAME})
  else()
    target_link_libraries(${PROGRAM} PRIVATE ${ARG_LINK})
  endif()
endfunction()

# The observation classes and drivers as a plugin for stock MRPT tools (rawlog-edit -p, RawLogViewer -l, rawlog-grabber -p).
function(perception_plugin)
  add_library(perception_mrpt_plugin MODULE ${CMAKE_SOURCE_DIR}/libperception/capture/plugin/Plugin.cpp)
  target_link_libraries(perception_mrpt_plugin PRIVATE perception::capture perception::grid)
endfunction()
