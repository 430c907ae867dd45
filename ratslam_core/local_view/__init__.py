"""Local view cells: scenes that are recognised, and their links to pose cells. ACRA 2004 section 3.3, ACRA 2006 section 7."""
