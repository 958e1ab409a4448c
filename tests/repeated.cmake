# REPEATED: tests that the asan preset leaves out, by their whole names; each runs code that another one runs there,
# too, and costs a third of a second or more under AddressSanitizer. (The test repeated_names fails for a name that is
# no test's.)
set(REPEATED)
function(repeated test)
  foreach(instance ${ARGN})
    list(APPEND REPEATED "${test}/${instance}")
  endforeach()
  set(REPEATED "${REPEATED}" PARENT_SCOPE)
endfunction()

# Whole tests, of which these run the same code: tests of each command; CoarseToFine.EmptyCoarseLevelsShowWhereToStart
# and ALevelEndsWhenItsLabelsHaveSettled; PrimalDual.EstimatesUntilTheGapIsAboutTheTolerance; the other tests of
# MemoryPlan; Scratch.GivesTheSameMeshOnTwoThreads and ScratchRefusals.OfFilesThatMayNotBeAsLarge;
# Contexts.ALimitAndACancelledRunLeaveOtherThreadsAlone; the tests of each reader and writer;
# Scan.TheSameBytesForAnyNumberOfThreads and Targets/Determinism.SameMeshBytesOnAnyNumberOfThreads;
# Reconstruct.GeoreferencedInputLosesNothing; Units.PowersOfTwoScaleTheMeshExactly; RoomFromInside and UnevenWall, of
# the scenes; EvaluateCommand.RefusesInOneLine; Evaluate.TheSameForAnyNumberOfThreads;
# SimplifyCommand.IsAStageOfReconstruct and WritesCoarserLevelsBesideIt; CompareCommand.TheExitCodeIsTheVerdict; the
# other tests of Simplify, TileTree, Remesh;
# CoarserLevels.AreWithinTheSumOfAllStepsOfTheFullMesh; Adapt.ABallOfUnevenDensityIsWholeAndRound; the other
# tests of LeafSurface; OrderOfSamples.WithScannersAndWeightsChangesNoByte.
list(APPEND REPEATED
  Scratch.TakesARunThatTurnsOutToNeedMore
  ScratchRefusals.AreNoneWhereTheDiskHasRoom
  ScratchRefusals.NameTheFolder
  ScratchPlan.WhatFitsStaysInMemory
  ScratchPlan.RefusesWhatDiskCannotTake
  Program.TheCommandsOfItsFirstPageWork
  Standstill.ManySweepsFromOnePlaceChangeNeitherVoxelNorSurface
  StreetSweep.IsJoinedAsFarAsItsRingsAre
  Facade.FromThePavementLosesNothing
  Tunnel.OpenAtBothEndsLosesNothing
  Terrain.FromTheAirLosesNothing
  Scan.RefusesInOneLineAndWritesNothing
  Scan.RefusesAPlaceBeforeTheWork
  EvaluateCommand.TheSameBytesForAnyNumberOfThreads
  Reconstruct.TheSameBytesForAnyNumberOfThreads
  Georeferenced.CoordinatesLoseNothing
  CoarseToFine.CoarseLevelsOfAnOpenSurfaceTakeABoundedShareOfTheWork
  PrimalDual.EstimatesPredictALargeLevelsGap
  MemoryPlan.OfTwoFarBallsIsThatOfTwoNearOnes
  MemoryPlan.OfACloudWithOneFarSampleIsThatOfTheRest
  Contexts.RunsOnThreadsOfTheirOwnGiveWhatEachGivesAlone
  FormatsAgree.OnMeshAndColors
  Plate.OfThreeVoxelsStaysWholeThoughCoarseLevelsLoseIt
  Units.MillimetersOrMetersGiveTheSameSurfaceButForTies
  SimplifyCommand.WritesFewerTrianglesWithinTheToleranceInEveryFormat
  CompareCommand.WritesWhatWasMeasured
  Simplify.TheSameForAnyNumberOfThreads
  Simplify.ReachesANumberOfTriangles
  Simplify.LeavesFewTrianglesAndTheVolume
  TileTree.AnyMixOfLevelsIsClosedWhereTheMeshIs
  TileTree.CoarserTilesHaveFewerTrianglesAndLargerErrors
  TileTree.ErrorsBoundTheDistanceBothWays
  TileTree.ThreadsDoNotMatter
  CoarserLevels.ThreadsDoNotMatter
  Remesh.EvenTrianglesOfTheSameSurface
  Remesh.GenusStaysWhereEdgesAreLargerThanDetails
  Remesh.ATightToleranceIsKeptBySmallerTriangles
  Remesh.TheSameForAnyNumberOfThreads
  Remesh.EdgesThatAScanRoundedAreSharpAgain
  SimplifyChecks.EachOfThemIsNeeded
  LeafSurface.OfOneLevelIsMarchingCubes
  Adapt.ThreadsDoNotMatter
  Adapt.AnEvenBallHasOneLevel
  LeafSurface.ThreadsDoNotMatter
  OrderOfSamples.WithNormalsChangesNoByte
  OrderOfSamples.WithoutDirectionsChangesNoByte
  OrderOfSamples.ChangesNeitherFoldsNorTheLambdaThatTheyChoose)

foreach(law SurfaceSamplesAreUniformAndOnTheSurface TessellationIsClosedAndHasTheStatedTopology
    DistanceAgreesWithAFineTessellation SignIsNegativeWithinTheSolidOnly RaysHitTheSurfaceFirstWhereTheTessellationDoes
    VolumeAndAreaMatchTheTessellation ScalesWithItsSize FillsABoxOfTheGivenSize)
  repeated(Shapes/EveryShape.${law} knot)
endforeach()
repeated(Shapes/EveryShapeScanned.TheDefaultOrbitSeesAllOfIt knot)
repeated(Shapes/EveryShapeScanned.CleanSamplesLieOnTheShape knot)
repeated(Shapes/EveryShapeWithAHole.LosesTheShareOfItsArea knot)

foreach(target scalar ssse3 sse4 avx2 avx3 avx3_dl avx3_zen4 avx3_spr)
  foreach(law RowsThatRestLoseNothing IsTheIterationOfThePaper GivesTheSameBitsOnEveryBackEnd KeepsTheConstraints)
    repeated(AllBackEnds/Sweep.${law} ${target}_threads1)
  endforeach()
  foreach(law AndItsAdjointAreAdjointOnRandomBands AdjointIsTheBackwardDifferenceWithTheRimsFlux)
    repeated(AllBackEnds/Gradient.${law} ${target}_threads1)
  endforeach()
  repeated(Targets/SorBackEnds.GiveTheSameBytes ${target}_threads1)
endforeach()
repeated(AllBackEnds/Sweep.RowsThatRestLoseNothing scalar_threads8)
repeated(Targets/Determinism.SameMeshBytesOnAnyNumberOfThreads scalar)
repeated(Seeds/EnergyOfRandomLevels.AgreesWithBruteForceOnTheDenseGrid isotropic3 isotropic4 anisotropic3 anisotropic4)
repeated(Variants/SorEquation.GivesTheSameBytesWhenEmptyRunsAreSkipped lexicographic renewed_always renewed_rarely
  without_snap red_black red_black_renewed_rarely red_black_without_snap)

foreach(neighbors 6 26)
  foreach(kind edge_length_isotropic edge_length_anisotropic cauchy_crofton_isotropic cauchy_crofton_anisotropic)
    if(neighbors EQUAL 26)
      repeated(GraphCut/EveryKind.FindsTheBestOfAllLabelingsOfTinyGrids neighbors26_${kind})
    endif()
    if(NOT "${neighbors} ${kind}" STREQUAL "6 edge_length_isotropic")
      repeated(GraphCut/EveryKind.DoesNotDependOnThreads neighbors${neighbors}_${kind})
    endif()
    if(NOT kind STREQUAL "cauchy_crofton_isotropic")
      foreach(law BandGrowsUntilItsCutIsThatOfTheWholeBox RimsOfAClosedShapeAgreeAtOnce)
        repeated(GraphCut/EveryKind.${law} neighbors${neighbors}_${kind})
      endforeach()
    endif()
  endforeach()
endforeach()

repeated(Shares/Labeling.IsThatOfAFlood 10 97)
repeated(Threads/EverySecondVertex.HasTheLabelsOfTheFinerGrid 1)
repeated(Shapes/BandAndWholeGrid.HaveTheSameSolution sphere1 sphere7 torus2 part3 part4 knot5 knot9 sheets6)
foreach(law DualBoundIsTheOneOfTheWholeGrid EnergiesAreThoseOfTheWholeGrid DualIsFeasibleOnTheWholeGrid
    CertifiedBoundHoldsForTheRescaledDual DataLeftOutCostNoMoreThanIsAllowed)
  repeated(Shapes/Certificate.${law} knot_air sphere_air part_air sheets_air sphere_anisotropic_air part_open
    knot_anisotropic_open)
endforeach()
repeated(Shapes/SorAndOptimum.NoStateBeatsTheDualBound part)
repeated(Shapes/PoissonSurface.IsClosedWithTheShapesComponentsAndGenus knot)
foreach(law IsTheSmoothedThresholdedField MeanAtTheSamplesIsTheMeanOfTheTrilinearInterpolation
    WithoutSmoothingIsTheThresholdedFieldItself)
  repeated(Shapes/Indicator.${law} knot)
endforeach()
repeated(Shapes/Topology.IsThatOfTheThresholdedSolve knot sheets)

foreach(law AxisPermutationsPermuteTheLabels AxisFlipsMoveTheSurfaceLittle)
  repeated(Shapes/Symmetry.${law} knot sphere part torus_noisy)
endforeach()
foreach(law ByTheCoarsestCellMovesTheLabelsAlong ByOneVoxelStaysWithinTheGap)
  repeated(Shapes/Translation.${law} knot sphere part torus_noisy)
endforeach()
repeated(Problems/Thresholds.AllGiveNearlyTheOptimalEnergy torus1 part2 knot3 sphere4 part5)
repeated(Methods/EveryMethod.GivesTheSameBytesForAnyNumberOfThreads tv tv_sor graph_cut_6 graph_cut_26 vrip)
repeated(Methods/EveryMethod.IsRefusedBeforeItsWorkWhenThePlanPassesTheLimit tv_sor)
repeated(Shapes/Segmenting.GivesAWatertightMeshWithTheShapesComponentsAndGenus torus_tv_sor
  sphere_tv sphere_tv_sor sphere_graph_cut_6 sphere_graph_cut_26
  sheets_tv sheets_tv_sor sheets_graph_cut_6 sheets_graph_cut_26)
repeated(Shapes/SharedEnergy.TheSorOfThePaperAndTvAgree sphere torus)
repeated(Shapes/SharedEnergy.AnisotropicTvAndTheCutReachTheSameEnergy sphere sheets)
foreach(shape arch knot part plate sheets sphere torus)
  repeated(Sweep/BuiltInShape.KeepsItsComponentsAndGenus ${shape}_64_3per10 ${shape}_64_100per10)
  if(NOT shape STREQUAL "plate")
    repeated(Sweep/BuiltInShape.KeepsItsComponentsAndGenus ${shape}_64_10per10)
  endif()
endforeach()
repeated(Planes/PlanarHole.OfTwentyVoxelsIsClosedByAPatchOfTheDisc skew)
repeated(Views/HalfSphere.ClosesAndTouchesNoBorderVertex up)
repeated(Share/Outlying.SamplesLeaveOneKnot 1)
repeated(ByLot/WrongSigns.AreNotTakenForDirections 1)
