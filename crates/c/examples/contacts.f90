! Three discs, a periodic box, and a list that is compared with the truth.
program contacts
    use contactbench
    implicit none

    real(c_double), target :: x(2, 3) = &
        reshape([0.25d0, 0.5d0, 1.0d0, 0.5d0, 3.75d0, 0.5d0], [2, 3])
    real(c_double), target :: r = 0.375d0
    type(contactbench_box), target :: channel
    type(contactbench_scene) :: scene
    type(contactbench_errors) :: errors
    type(c_ptr) :: detector, tracker
    integer(c_int32_t), pointer :: pairs(:, :), images(:, :)
    integer(c_int32_t), target :: none(2) = 0
    integer :: k

    scene%n = 3
    scene%dim = 2
    scene%x = c_loc(x)
    scene%radii = 1
    scene%r = c_loc(r)
    call check(contactbench_new("streamed-nbs" // c_null_char, "exact" // c_null_char, &
        1_c_size_t, 0_c_int64_t, detector))

    ! In open space the first two touch.
    call check(contactbench_contacts(detector, scene))
    call c_f_pointer(contactbench_pairs(detector), pairs, [2_c_size_t, contactbench_count(detector)])
    print '(a, *(2x, i0, ",", i0))', "open:", pairs

    ! In a channel of length 4 the last one also touches the first.
    channel%vectors = reshape([4d0, 0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 0d0, 1d0], [3, 3])
    channel%periodic = [1, 0, 0]
    scene%bounds = c_loc(channel)
    call check(contactbench_contacts(detector, scene))
    call c_f_pointer(contactbench_pairs(detector), pairs, [2_c_size_t, contactbench_count(detector)])
    call c_f_pointer(contactbench_images(detector), images, shape(pairs))
    do k = 1, size(pairs, 2)
        print '(a, i0, ",", i0, a, i0, ",", i0)', "channel: ", pairs(:, k), "  image ", images(:, k)
    end do

    ! A tracker keeps a list of near pairs while particles move.
    call check(contactbench_tracker_new("verlet(streamed-nbs,skin=0.5)" // c_null_char, &
        c_null_char, 1_c_size_t, 0_c_int64_t, tracker))
    do k = 0, 1
        call check(contactbench_tracker_step(tracker, scene))
        print '(a, i0, a, i0)', "tracked: ", contactbench_tracker_count(tracker), &
            "  built ", contactbench_tracker_built(tracker)
        x(1, 2) = x(1, 2) + 0.125d0
    end do
    x(1, 2) = 1d0
    call contactbench_tracker_free(tracker)

    ! A list that misses a contact.
    call check(contactbench_verify(scene, c_null_char, 1_c_size_t, [1, 0], c_loc(none), &
        errors))
    print '(a, i0, a, i0, a)', "list: ", errors%missed, " of ", errors%contacts, " missed"
    call contactbench_free(detector)

contains

    subroutine check(code)
        integer(c_int), intent(in) :: code
        character(kind=c_char), pointer :: said(:)
        integer :: length

        if (code == contactbench_ok) return
        call c_f_pointer(contactbench_last_error(), said, [1000])
        length = 1
        do while (said(length) /= c_null_char)
            length = length + 1
        end do
        print *, said(:length - 1)
        stop 1
    end subroutine
end program
