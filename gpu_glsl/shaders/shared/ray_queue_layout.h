// How given rays are shared out to groups of persistent threads. One text for C++ and GLSL.
#pragma once

const uint kPersistentGroupSize = 1024u;  // invocations

const uint kRayBlock = 256u;  // rays that follow each other, of one group

// The counts of the queue, each 0 between dispatches.
const int kRaysTaken = 0;
const int kGroupsEnded = 1;
const int kQueueCounts = 2;
