"""The experience map and what is read off it: relaxation, temporal map, places. ACRA 2005 section 4, ACRA 2006 section 3."""
