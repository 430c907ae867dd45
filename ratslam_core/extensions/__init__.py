"""What is ours and stands beside the papers' algorithm."""
