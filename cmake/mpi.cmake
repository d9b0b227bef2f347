# Training by several processes (docs/parallel.md): AUTO where MPI is found.
set(VKOPPLE_MPI AUTO CACHE STRING "Train by several processes over MPI: ON, OFF, or AUTO where it is found")
set(vkopple_mpi OFF)
if(VKOPPLE_MPI STREQUAL AUTO)
  find_package(MPI QUIET COMPONENTS CXX)
  set(vkopple_mpi ${MPI_CXX_FOUND})
elseif(VKOPPLE_MPI)
  find_package(MPI REQUIRED COMPONENTS CXX)
  set(vkopple_mpi ON)
endif()
if(vkopple_mpi)
  # One library in two files: nothing else is compiled another way for it.
  target_link_libraries(vkopple_train PUBLIC $<LINK_ONLY:MPI::MPI_CXX>)
  set_source_files_properties(train/parallel/join.cpp train/parallel/mpi_peers.cpp PROPERTIES
    COMPILE_DEFINITIONS "VKOPPLE_MPI;OMPI_SKIP_MPICXX;MPICH_SKIP_MPICXX" INCLUDE_DIRECTORIES "${MPI_CXX_INCLUDE_DIRS}")
endif()
