# Runs on many machines: the program soapfilm-mpi, which mpirun starts, links Open MPI by src/soapfilm/mpi; the engine and
# the program soapfilm know ranks, not MPI.
find_package(MPI REQUIRED COMPONENTS C)
file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/soapfilm/mpi/*.cpp)
add_library(soapfilm_mpi STATIC ${sources})
target_compile_definitions(soapfilm_mpi PRIVATE OMPI_SKIP_MPICXX)  # the C interface alone
target_link_libraries(soapfilm_mpi PUBLIC soapfilm_engine PRIVATE soapfilm_options fmt::fmt MPI::MPI_C)

# With these functions of its own the linker does not look for those of soapfilm_commands.
add_executable(soapfilm_mpi_cli ${PROJECT_SOURCE_DIR}/cli/main.cpp ${PROJECT_SOURCE_DIR}/cli/ranks.cpp)
set_target_properties(soapfilm_mpi_cli PROPERTIES OUTPUT_NAME soapfilm-mpi)
target_compile_definitions(soapfilm_mpi_cli PRIVATE SOAPFILM_MPI)
target_link_libraries(soapfilm_mpi_cli PRIVATE soapfilm_commands soapfilm_mpi)
install(TARGETS soapfilm_mpi_cli COMPONENT mpi)
configure_file(${PROJECT_SOURCE_DIR}/packaging/debian/soapfilm-mpi.1.in ${PROJECT_BINARY_DIR}/generated/soapfilm-mpi.1
  @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/generated/soapfilm-mpi.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT mpi)
