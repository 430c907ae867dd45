import ratslam_live as ratslam_live  # our packages, whatever else has their names
