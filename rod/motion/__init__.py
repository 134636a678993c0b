"""Motion of rods: a scheme that keeps energy, damping, air behind valves, events."""

from rod.motion.motion import Motion as Motion
from rod.motion.moving import Moving as Moving
