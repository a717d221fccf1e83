// A formula from nowhere (@cite Nobody1900).
