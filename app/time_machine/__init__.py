"""Any moment of a run, shown again and gone on from."""
