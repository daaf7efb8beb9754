// Of deferred/settle.comp.glsl: its texture unit, which nothing else uses, and how many samplers a program has at most.
#ifndef CANDIL_SHARED_SETTLE_H
#define CANDIL_SHARED_SETTLE_H

#define SETTLE_UNIT 13
#define SETTLE_SAMPLERS 16
#define SETTLE_BUFFERS 8 // every device has so many for a program

#endif
