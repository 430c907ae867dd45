"""The simulated office: worlds as data, a robot in pymunk, its camera, sonars and odometry."""

# pyright: basic
import lazy_loader

import ratslam_live as ratslam_live  # where kernels are kept

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
